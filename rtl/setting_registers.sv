// SPDX-License-Identifier: Apache-2.0
// Registers that only software writes and the pipeline reads (docs/reference/coprocessor.md, "Registers"): CTRL, LOOP and
// SAFETY, whose fields go to several units, and around them those that <settings> of the register description lists.
// Reserved values are refused here.
//
// Latency: a write counts from its edge on. Formats: steps u31, Q1.31; thresholds u32, Q1.31.
module setting_registers #(
  parameter int Block = 1,     // CTRL.BLOCK and GUARD are there
  parameter int Harmonics = 1, // CTRL.CORRECT is there
  parameter int Safety = 1,    // SAFETY, CTRL.IE_SAFETY and parity bits are there
  parameter int Channels = 1
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        clear_i,    // soft reset
  input  logic        write_i,    // of any register, but no step of 1.0 or more
  input  capsoc_coprocessor_selects_t select_i,
  input  logic [31:0] pwdata_i,
  output logic        reserved_o,    // CTRL.REF = 3, CTRL.BLOCK or CORRECT that is not there
  output logic        adc_enable_o,
  output logic        freeze_o,
  output enables_t    enables_o,
  output settings_t   settings_o,
  input  logic        boundary_i,
  // With boundary_i: a register, SAFETY does not fit its parity bit
  output logic        fault_o,
  output logic        safety_fault_o,
  input  logic               shift_i,
  input  logic               clear_context_i,
  input  chain_t      chain_i,
  output chain_t      chain_o
);

  localparam logic [31:0] CtrlReset = capsoc_coprocessor_pkg::CTRL_RESET;
  localparam int RefLow  = capsoc_coprocessor_pkg::CTRL_REF_LSB;
  localparam int RefHigh = capsoc_coprocessor_pkg::CTRL_REF_MSB;

  logic       demod_q, calib_q, adc_q, ie_result_q, ie_lock_q, ie_error_q;
  logic       ie_turn_q, ie_alarm_q, ie_safety_q, freeze_q, block_q, guard_q, correct_q;
  logic [1:0] ref_q;

  logic write_ctrl, clear_ctrl;
  assign write_ctrl = write_i & select_i.CTRL;
  assign clear_ctrl = Channels > 1 && clear_context_i;

  // CTRL, LOOP, SAFETY and their parity bits
  logic shift;
  logic [42:0] moved;
  assign shift = Channels > 1 && shift_i;

  // A word with SRST is not looked at any further.
  logic reserved_ref;
  assign reserved_ref = &pwdata_i[RefHigh:RefLow];
  assign reserved_o = write_ctrl & ~clear_i &
      (reserved_ref | (Block == 0 & pwdata_i[capsoc_coprocessor_pkg::CTRL_BLOCK_LSB]) |
       (Harmonics == 0 & pwdata_i[capsoc_coprocessor_pkg::CTRL_CORRECT_LSB]));

  logic [31:0] ctrl_data;
  assign ctrl_data = clear_i ? CtrlReset : pwdata_i;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      demod_q     <= CtrlReset[capsoc_coprocessor_pkg::CTRL_DEMOD_LSB];
      calib_q     <= CtrlReset[capsoc_coprocessor_pkg::CTRL_CALIB_LSB];
      ref_q       <= CtrlReset[RefHigh:RefLow];
      adc_q       <= CtrlReset[capsoc_coprocessor_pkg::CTRL_ADC_LSB];
      ie_result_q <= CtrlReset[capsoc_coprocessor_pkg::CTRL_IE_RESULT_LSB];
      ie_lock_q   <= CtrlReset[capsoc_coprocessor_pkg::CTRL_IE_LOCK_LSB];
      ie_error_q  <= CtrlReset[capsoc_coprocessor_pkg::CTRL_IE_ERROR_LSB];
      ie_turn_q   <= CtrlReset[capsoc_coprocessor_pkg::CTRL_IE_TURN_LSB];
      ie_alarm_q  <= CtrlReset[capsoc_coprocessor_pkg::CTRL_IE_ALARM_LSB];
      ie_safety_q <= CtrlReset[capsoc_coprocessor_pkg::CTRL_IE_SAFETY_LSB];
      freeze_q    <= CtrlReset[capsoc_coprocessor_pkg::CTRL_FREEZE_LSB];
      block_q     <= CtrlReset[capsoc_coprocessor_pkg::CTRL_BLOCK_LSB];
      guard_q     <= CtrlReset[capsoc_coprocessor_pkg::CTRL_GUARD_LSB];
      correct_q   <= CtrlReset[capsoc_coprocessor_pkg::CTRL_CORRECT_LSB];
    end else if (write_ctrl | clear_ctrl) begin
      demod_q     <= ctrl_data[capsoc_coprocessor_pkg::CTRL_DEMOD_LSB];
      calib_q     <= ctrl_data[capsoc_coprocessor_pkg::CTRL_CALIB_LSB];
      if (clear_i | ~reserved_ref) ref_q <= ctrl_data[RefHigh:RefLow];
      adc_q       <= ctrl_data[capsoc_coprocessor_pkg::CTRL_ADC_LSB];
      ie_result_q <= ctrl_data[capsoc_coprocessor_pkg::CTRL_IE_RESULT_LSB];
      ie_lock_q   <= ctrl_data[capsoc_coprocessor_pkg::CTRL_IE_LOCK_LSB];
      ie_error_q  <= ctrl_data[capsoc_coprocessor_pkg::CTRL_IE_ERROR_LSB];
      ie_turn_q   <= ctrl_data[capsoc_coprocessor_pkg::CTRL_IE_TURN_LSB];
      ie_alarm_q  <= ctrl_data[capsoc_coprocessor_pkg::CTRL_IE_ALARM_LSB];
      ie_safety_q <= ctrl_data[capsoc_coprocessor_pkg::CTRL_IE_SAFETY_LSB] & Safety != 0;
      freeze_q    <= ctrl_data[capsoc_coprocessor_pkg::CTRL_FREEZE_LSB];
      block_q     <= ctrl_data[capsoc_coprocessor_pkg::CTRL_BLOCK_LSB] & Block != 0;
      guard_q     <= ctrl_data[capsoc_coprocessor_pkg::CTRL_GUARD_LSB] & Block != 0;
      correct_q   <= ctrl_data[capsoc_coprocessor_pkg::CTRL_CORRECT_LSB] & Harmonics != 0;
    end else if (shift) begin
      {demod_q, calib_q, ref_q, adc_q, ie_result_q, ie_lock_q, ie_error_q, ie_turn_q, ie_alarm_q, ie_safety_q, freeze_q,
       block_q, guard_q, correct_q} <= moved[42:28];
    end
  end
  assign adc_enable_o = adc_q;
  assign freeze_o     = freeze_q;
  assign enables_o.safety = ie_safety_q;
  assign enables_o.alarm  = ie_alarm_q;
  assign enables_o.turn   = ie_turn_q;
  assign enables_o.error  = ie_error_q;
  assign enables_o.lock   = ie_lock_q;
  assign enables_o.result = ie_result_q;

  localparam logic [31:0] LoopReset    = capsoc_coprocessor_pkg::LOOP_RESET;
  localparam int KpLow  = capsoc_coprocessor_pkg::LOOP_KP_LSB;
  localparam int KpHigh = capsoc_coprocessor_pkg::LOOP_KP_MSB;
  localparam int KiLow  = capsoc_coprocessor_pkg::LOOP_KI_LSB;
  localparam int KiHigh = capsoc_coprocessor_pkg::LOOP_KI_MSB;
  logic       write_loop;
  logic [4:0] kp_q, ki_q;
  assign write_loop = write_i & select_i.LOOP;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      kp_q <= LoopReset[KpHigh:KpLow];
      ki_q <= LoopReset[KiHigh:KiLow];
    end else if (clear_i | write_loop) begin
      kp_q <= clear_i ? LoopReset[KpHigh:KpLow] : pwdata_i[KpHigh:KpLow];
      ki_q <= clear_i ? LoopReset[KiHigh:KiLow] : pwdata_i[KiHigh:KiLow];
    end else if (shift) begin
      {kp_q, ki_q} <= moved[27:18];
    end
  end

  // SAFETY
  capsoc_coprocessor_safety_t safety_data, safety;
  logic       write_safety, unused_safety, bad_parity_q;
  logic [3:0] mechanisms_q;  // MISSED, JUMP, MISFIT, PARITY
  logic [4:0] error_limit_q, step_limit_q;
  assign safety_data   = pwdata_i;
  assign write_safety  = write_i & select_i.SAFETY & Safety != 0;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      {mechanisms_q, bad_parity_q, error_limit_q, step_limit_q} <= '0;
    end else if (clear_i) begin
      {mechanisms_q, bad_parity_q, error_limit_q, step_limit_q} <= '0;
    end else if (write_safety) begin
      mechanisms_q  <= {safety_data.MISSED, safety_data.JUMP, safety_data.MISFIT, safety_data.PARITY};
      bad_parity_q  <= safety_data.BAD_PARITY;
      error_limit_q <= safety_data.ERROR_LIMIT;
      step_limit_q  <= safety_data.STEP_LIMIT;
    end else if (shift) begin
      {mechanisms_q, bad_parity_q, error_limit_q, step_limit_q} <= moved[17:3];
    end
  end
  assign unused_safety = ^safety_data;
  assign safety.RESERVED_31_29 = '0;
  assign safety.STEP_LIMIT     = step_limit_q;
  assign safety.RESERVED_23_21 = '0;
  assign safety.ERROR_LIMIT    = error_limit_q;
  assign safety.RESERVED_15_9  = '0;
  assign safety.BAD_PARITY     = bad_parity_q;
  assign safety.RESERVED_7_4   = '0;
  assign {safety.MISSED, safety.JUMP, safety.MISFIT, safety.PARITY} = mechanisms_q;

  logic [2:0] parity_q;
  chain_t chain;
  context_chain #(.Channels(Channels), .Width(43)) u_chain (
    .kept_i({demod_q, calib_q, ref_q, adc_q, ie_result_q, ie_lock_q, ie_error_q, ie_turn_q, ie_alarm_q, ie_safety_q, freeze_q,
             block_q, guard_q, correct_q, kp_q, ki_q, mechanisms_q, bad_parity_q, error_limit_q, step_limit_q, parity_q}),
    .chain_i, .moved_o(moved), .chain_o(chain)
  );

  // The registers whose word is all that the pipeline reads
  capsoc_coprocessor_settings_t registers;
  logic registers_fault;
  capsoc_coprocessor_settings #(
    .Parity (Safety),
    .Channels (Channels)
  ) u_registers (
    .clk_i, .rst_ni,
    .clear_i, .write_i, .select_i,
    .write_data_i (pwdata_i),
    .bad_parity_i (bad_parity_q),
    .settings_o   (registers),
    .fault_o      (registers_fault),
    .shift_i,
    .chain_i      (chain),
    .chain_o
  );

  // A parity bit for each of SAFETY, LOOP, CTRL.
  logic [2:0] written, next_parity, parity;
  logic [1:0] ref_d;
  assign ref_d       = clear_i | ~reserved_ref ? ctrl_data[RefHigh:RefLow] : ref_q;
  assign written     = {write_safety, write_loop, write_ctrl};
  assign next_parity = {^{safety_data.MISSED, safety_data.JUMP, safety_data.MISFIT, safety_data.PARITY,
                          safety_data.BAD_PARITY, safety_data.ERROR_LIMIT, safety_data.STEP_LIMIT},
                        ^{pwdata_i[KpHigh:KpLow], pwdata_i[KiHigh:KiLow]},
                        ^{ctrl_data[capsoc_coprocessor_pkg::CTRL_DEMOD_LSB],
                          ctrl_data[capsoc_coprocessor_pkg::CTRL_CALIB_LSB], ref_d,
                          ctrl_data[capsoc_coprocessor_pkg::CTRL_ADC_LSB],
                          ctrl_data[capsoc_coprocessor_pkg::CTRL_IE_RESULT_LSB],
                          ctrl_data[capsoc_coprocessor_pkg::CTRL_IE_LOCK_LSB],
                          ctrl_data[capsoc_coprocessor_pkg::CTRL_IE_ERROR_LSB],
                          ctrl_data[capsoc_coprocessor_pkg::CTRL_IE_TURN_LSB],
                          ctrl_data[capsoc_coprocessor_pkg::CTRL_IE_ALARM_LSB],
                          ctrl_data[capsoc_coprocessor_pkg::CTRL_IE_SAFETY_LSB] & Safety != 0,
                          ctrl_data[capsoc_coprocessor_pkg::CTRL_FREEZE_LSB],
                          ctrl_data[capsoc_coprocessor_pkg::CTRL_BLOCK_LSB] & Block != 0,
                          ctrl_data[capsoc_coprocessor_pkg::CTRL_GUARD_LSB] & Block != 0,
                          ctrl_data[capsoc_coprocessor_pkg::CTRL_CORRECT_LSB] & Harmonics != 0}} ^ {3{bad_parity_q}};
  localparam logic [2:0] ResetParity = {3{Safety != 0}} & {1'b0, ^LoopReset, ^CtrlReset};
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) parity_q <= ResetParity;
    else if (clear_i) parity_q <= ResetParity;
    else if (|written) parity_q <= ((parity_q & ~written) | (next_parity & written)) & {3{Safety != 0}};
    else if (shift) parity_q <= moved[2:0];
  end
  assign parity = {^{mechanisms_q, bad_parity_q, error_limit_q, step_limit_q},
                   ^{kp_q, ki_q},
                   ^{demod_q, calib_q, ref_q, adc_q, ie_result_q, ie_lock_q, ie_error_q, ie_turn_q, ie_alarm_q,
                     ie_safety_q, freeze_q, block_q, guard_q, correct_q}};
  assign fault_o        = boundary_i ? Safety != 0 & ((|(parity ^ parity_q)) | registers_fault) : 1'b0;
  assign safety_fault_o = boundary_i ? Safety != 0 & (parity[2] ^ parity_q[2]) : 1'b0;

  assign settings_o.demod     = demod_q;
  assign settings_o.calib     = calib_q;
  assign settings_o.block     = block_q;
  assign settings_o.guard     = guard_q;
  assign settings_o.correct   = correct_q;
  assign settings_o.source    = ref_q;
  assign settings_o.kp        = kp_q;
  assign settings_o.ki        = ki_q;
  assign settings_o.registers = registers;
  assign settings_o.safety    = safety;

  logic unused_selects;  // of the other registers
  assign unused_selects = ^select_i;

endmodule
