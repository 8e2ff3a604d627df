// SPDX-License-Identifier: Apache-2.0
// One register of the bank, any, against a shadow that follows the document's rules
// (register_bank.sv). The conversion of a 48-bit register to words is pair_words.sv, which has its own
// proof.
module register_bank_properties (
  input logic        clk_i,
  input logic        psel_i, penable_i, pwrite_i,
  input logic [11:0] paddr_i,
  input logic [31:0] pwdata_i,
  input logic [3:0]  pstrb_i,
  input logic        busy_i, busy_next_i, stream_early_i, soft_early_i, boundary_i,
  input state_we_t   state_we_i,
  input state_t      state_i,
  input logic        commit_i,
  input flags_t      flags_i,
  input status_t     status_i,
  input logic [31:0] turn_flags_i,
  input logic [31:0] result_i
);

  logic in_reset = 1'b1;
  always @(posedge clk_i) in_reset <= 1'b0;

  logic        pready, pslverr, irq, clear, adc_enable, soft_valid, load, frozen, pending, distrust, bad_parity, bad_safety;
  logic [31:0] prdata, soft_u;
  logic [3:0]  result_select;
  settings_t   settings;
  correction_t correction;
  state_t      state;
  register_bank dut (
    .clk_i, .rst_ni (~in_reset),
    .psel_i, .penable_i, .pwrite_i, .paddr_i, .pwdata_i, .pstrb_i,
    .pready_o (pready), .prdata_o (prdata), .pslverr_o (pslverr), .irq_o (irq),
    .clear_o (clear), .adc_enable_o (adc_enable), .soft_valid_o (soft_valid), .soft_u_o (soft_u),
    .load_o (load), .busy_i, .busy_next_i, .stream_early_i, .soft_early_i,
    .settings_o (settings), .correction_o (correction), .frozen_o (frozen),
    .pending_o (pending), .distrust_o (distrust), .bad_parity_o (bad_parity), .bad_safety_o (bad_safety),
    .state_o (state), .boundary_i, .state_we_i, .state_i,
    .commit_i, .flags_i, .status_i, .turn_flags_i,
    .result_select_o (result_select), .result_i
  );

  (* hierconn *) logic [31:0] \dut.u_words.valid_q ;
  (* hierconn *) logic [4:0]  \dut.u_words.probe ;
  (* hierconn *) logic [31:0] \dut.u_words.probed ;
  (* hierconn *) logic [15:0] \dut.flags ;
  (* hierconn *) logic [31:0] \dut.samples ;
  (* hierconn *) logic [31:0] \dut.early_count ;
  (* hierconn *) logic [5:0] \dut.enables ;
  (* hierconn *) logic [2:0] \dut.u_settings.parity_q ;
  (* hierconn *) logic [9:0] \dut.u_settings.u_registers.parity_q ;
  (* hierconn *) logic \dut.freeze ;
  logic [31:0] valids, probed;
  enables_t    enables;
  logic [15:0] flags;
  assign valids = \dut.u_words.valid_q ;
  assign probed = \dut.u_words.probed ;
  assign flags  = \dut.flags ;
  assign enables = \dut.enables ;

  logic       access, write, read;
  logic [5:0] word;
  assign word   = paddr_i[7:2];
  assign access = psel_i & penable_i & ~pslverr & paddr_i[11:8] == 4'd0;
  assign write  = access & pwrite_i;
  assign read   = access & ~pwrite_i;

  capsoc_coprocessor_settings_t registers;
  steps_t      steps;
  weights_t    weights, weights_in;
  parameters_t parameters, parameters_in;
  assign registers     = settings.registers;
  assign steps         = {registers.STEP_AU, registers.STEP_BU, registers.STEP_CU,
                          registers.STEP_AV, registers.STEP_BV, registers.STEP_CV};
  assign weights       = state.weights;
  assign weights_in    = state_i.weights;
  assign parameters    = state.parameters;
  assign parameters_in = state_i.parameters;

  // The watched word and its kind.
  (* anyconst *) logic [5:0] watched;
  logic is_pair, is_step, is_threshold, is_judge, is_amplitude, is_parameter;
  assign is_pair      = watched[5:1] == 5'h03 | watched[5:1] == 5'h04 |
                        (watched >= 6'h14 & watched <= 6'h1F);
  assign is_step      = watched >= 6'h0A & watched <= 6'h0F;
  assign is_threshold = watched == 6'h11 | watched == 6'h12;
  assign is_judge     = watched == 6'h26 | watched == 6'h27;
  assign is_amplitude = watched == 6'h20 | watched == 6'h21;
  assign is_parameter = watched >= 6'h20 & watched <= 6'h25;

  // The register after it, what the pipeline gives it at this edge, and its reset value.
  logic [47:0] now, given, start;
  logic        gives;
  always @* begin
    now   = 48'd0;
    given = 48'd0;
    start = 48'd0;
    gives = 1'b0;
    case (watched)
      6'h02: now = {33'd0, enables[5], settings.correct, enables[4:0], settings.guard, settings.block, \dut.freeze , adc_enable, settings.source, settings.calib,
                    settings.demod};
      6'h04: now = {32'd0, flags};
      6'h06, 6'h07: begin now = state.freq; given = state_i.freq; gives = state_we_i.freq; end
      6'h08, 6'h09: begin now = state.phase; given = state_i.phase; gives = state_we_i.phase; end
      6'h0A: begin now = {17'd0, steps.au}; start = {16'd0, capsoc_coprocessor_pkg::STEP_AU_RESET}; end
      6'h0B: begin now = {17'd0, steps.bu}; start = {16'd0, capsoc_coprocessor_pkg::STEP_BU_RESET}; end
      6'h0C: begin now = {17'd0, steps.cu}; start = {16'd0, capsoc_coprocessor_pkg::STEP_CU_RESET}; end
      6'h0D: begin now = {17'd0, steps.av}; start = {16'd0, capsoc_coprocessor_pkg::STEP_AV_RESET}; end
      6'h0E: begin now = {17'd0, steps.bv}; start = {16'd0, capsoc_coprocessor_pkg::STEP_BV_RESET}; end
      6'h0F: begin now = {17'd0, steps.cv}; start = {16'd0, capsoc_coprocessor_pkg::STEP_CV_RESET}; end
      6'h10: begin now = {35'd0, settings.ki, 3'd0, settings.kp}; start = {16'd0, capsoc_coprocessor_pkg::LOOP_RESET}; end
      6'h11: begin now = {16'd0, registers.LOCK_THRESHOLD}; start = {16'd0, capsoc_coprocessor_pkg::LOCK_THRESHOLD_RESET}; end
      6'h12: begin now = {16'd0, registers.DIVERGE_THRESHOLD}; start = {16'd0, capsoc_coprocessor_pkg::DIVERGE_THRESHOLD_RESET}; end
      6'h14, 6'h15: begin now = weights.au; given = weights_in.au; gives = state_we_i.weights_u; start = {1'b0, capsoc_coprocessor_pkg::AU_HI_RESET, 15'd0}; end
      6'h16, 6'h17: begin now = weights.bu; given = weights_in.bu; gives = state_we_i.weights_u; end
      6'h18, 6'h19: begin now = weights.cu; given = weights_in.cu; gives = state_we_i.weights_u; end
      6'h1A, 6'h1B: begin now = weights.av; given = weights_in.av; gives = state_we_i.weights_v; end
      6'h1C, 6'h1D: begin now = weights.bv; given = weights_in.bv; gives = state_we_i.weights_v; start = {1'b0, capsoc_coprocessor_pkg::BV_HI_RESET, 15'd0}; end
      6'h1E, 6'h1F: begin now = weights.cv; given = weights_in.cv; gives = state_we_i.weights_v; end
      6'h20: begin now = {16'd0, parameters.a1}; given = {16'd0, parameters_in.a1}; start = {16'd0, capsoc_coprocessor_pkg::A1_RESET}; end
      6'h21: begin now = {16'd0, parameters.a2}; given = {16'd0, parameters_in.a2}; start = {16'd0, capsoc_coprocessor_pkg::A2_RESET}; end
      6'h22: begin now = {16'd0, parameters.b1}; given = {16'd0, parameters_in.b1}; end
      6'h23: begin now = {16'd0, parameters.b2}; given = {16'd0, parameters_in.b2}; end
      6'h24: begin now = {16'd0, parameters.beta}; given = {16'd0, parameters_in.beta}; end
      6'h25: begin now = {16'd0, parameters.phi}; given = {16'd0, parameters_in.phi}; end
      6'h26: begin now = {16'd0, registers.JUDGE}; start = {16'd0, capsoc_coprocessor_pkg::JUDGE_RESET}; end
      6'h27: now = {16'd0, registers.TURN_LIMIT};
      6'h2B: now = {16'd0, settings.safety};
      default: now = 48'd0;
    endcase
    if (is_parameter) gives = state_we_i.parameters;
  end

  // Words of a pair, and the value that a write of HI gives it. Of a LO that is watched the memory
  // holds the stage, of a HI the read latch.
  logic [31:0] high, low, stage;
  logic [47:0] written_coefficient, written_phase;
  logic        held;
  logic [31:0] kept;
  pair_words reference_words (
    .coefficient_i (watched[4]), .value_i (now), .high_o (high), .low_o (low),
    .high_i (pwdata_i), .low_i (stage), .coefficient_o (written_coefficient),
    .phase_o (written_phase)
  );
  assign stage = held ? kept : 32'd0;

  // Set at this edge: RESULT, CLIP, SAT, ZERO, EARLY, LOCKCHG, DIVERGED, MIRRORCHG, CONFIG, TURN, ALARM,
  // UNSETTLED, PARITY, MISFIT, JUMP, MISSED.
  logic       refused;
  logic [15:0] set;
  assign refused = write & ((pwdata_i[31] & (word >= 6'h0A & word <= 6'h0F | word[5:1] == 5'h10)) |
                            (word == 6'h02 & ~pwdata_i[31] & pwdata_i[3:2] == 2'd3) |
                            (word == 6'h2A & busy_next_i));
  assign set = {flags_i.safety & {4{commit_i & boundary_i}},
                {flags_i.unsettled, flags_i.alarm, flags_i.turn} & {3{commit_i & boundary_i}},
                refused,
                {flags_i.mirrorchg, flags_i.diverged, flags_i.lockchg} & {3{commit_i & boundary_i}},
                stream_early_i | soft_early_i,
                {flags_i.zero, flags_i.sat, flags_i.clip, 1'b1} & {4{commit_i & boundary_i}}};

  logic now_exists;
  assign now_exists = watched == 6'h02 | watched == 6'h10 | is_step | is_threshold | is_judge |
                      is_parameter | watched == 6'h2B;

  // The value that the register has to have after the edge.
  logic [47:0] due, plain;
  logic        soft_reset, hit;
  assign soft_reset = write & word == 6'h02 & pwdata_i[31];
  assign hit        = write & word == watched;
  always @* begin
    plain = {16'd0, pwdata_i};
    if (watched == 6'h02) begin
      plain = {33'd0, pwdata_i[14:0]};
      if (pwdata_i[3:2] == 2'd3) plain[3:2] = now[3:2];
    end
    if (watched == 6'h26) plain = {26'd0, pwdata_i[21:0]};
    if (watched == 6'h10) plain = {35'd0, pwdata_i[12:8], 3'd0, pwdata_i[4:0]};
    if (watched == 6'h2B) plain = {16'd0, pwdata_i & capsoc_coprocessor_pkg::SAFETY_READABLE};
    due = boundary_i & gives ? given : now;
    if (watched == 6'h04) due = {32'd0, (now[15:0] | set) & ~(pwdata_i[15:0] & {16{hit}})};
    else if (is_pair) begin
      // Only a watched LO knows the stage; a watched HI is followed without its writes.
      if (~watched[0] & write & word == {watched[5:1], 1'b1}) begin
        due = watched[4] ? written_coefficient : written_phase;
      end
      if (write & word == 6'h05 & pwdata_i[2] & watched[5:1] == 5'h04) due = 48'd0;
    end else if (hit & ~((is_step | is_amplitude) & pwdata_i[31]) & now_exists) begin
      due = plain;
    end
    if (soft_reset) due = start;
  end

  // The memory's word.
  logic memory_word, fills, clears;
  assign memory_word = is_pair | is_step | is_threshold | is_judge | watched == 6'h28 | watched == 6'h2B;
  assign fills       = (is_pair & watched[0] & read & word == watched) |
                       (((is_pair & ~watched[0]) | is_threshold | is_judge | watched == 6'h28 | watched == 6'h2B) & hit) |
                       (is_step & hit & ~pwdata_i[31]);
  assign clears      = is_pair & ~watched[0] & write & word == {watched[5:1], 1'b1};

  logic [47:0] expected;
  logic        blind;
  always @(posedge clk_i) begin
    expected <= in_reset ? start : due;
    // After a write of the HI that is watched the shadow does not know the value.
    blind <= ~in_reset & is_pair & watched[0] & hit;
    if (in_reset | soft_reset) held <= 1'b0;
    else held <= fills | clears | held;
    if (fills) kept <= pwrite_i ? pwdata_i : low;
    if (clears) kept <= 32'd0;
  end

  // Parity: a write of the bus while BAD_PARITY is set leaves the wrong bit; the pipeline and a reset the right one.
  logic guarded, rewritten, wrong, parity;
  assign guarded   = now_exists | is_pair;
  assign rewritten = (hit & now_exists & ~((is_step | is_amplitude) & pwdata_i[31])) |
                     (is_pair & write & word == {watched[5:1], 1'b1}) |
                     (write & word == 6'h05 & pwdata_i[2] & watched[5:1] == 5'h04);
  always @(posedge clk_i) begin
    if (in_reset | soft_reset) wrong <= 1'b0;
    else if (rewritten) wrong <= settings.safety.BAD_PARITY;
    else if (boundary_i & gives) wrong <= 1'b0;
  end
  (* hierconn *) logic \dut.u_state.u_freq.parity_q ;
  (* hierconn *) logic \dut.u_state.u_phase.parity_q ;
  (* hierconn *) logic \dut.u_state.u_au.parity_q ;
  (* hierconn *) logic \dut.u_state.u_bu.parity_q ;
  (* hierconn *) logic \dut.u_state.u_cu.parity_q ;
  (* hierconn *) logic \dut.u_state.u_av.parity_q ;
  (* hierconn *) logic \dut.u_state.u_bv.parity_q ;
  (* hierconn *) logic \dut.u_state.u_cv.parity_q ;
  (* hierconn *) logic \dut.u_state.u_a1.parity_q ;
  (* hierconn *) logic \dut.u_state.u_a2.parity_q ;
  (* hierconn *) logic \dut.u_state.u_b1.parity_q ;
  (* hierconn *) logic \dut.u_state.u_b2.parity_q ;
  (* hierconn *) logic \dut.u_state.u_beta.parity_q ;
  (* hierconn *) logic \dut.u_state.u_phi.parity_q ;
  always @* begin
    case (watched)
      6'h06, 6'h07: parity = \dut.u_state.u_freq.parity_q ;
      6'h08, 6'h09: parity = \dut.u_state.u_phase.parity_q ;
      6'h14, 6'h15: parity = \dut.u_state.u_au.parity_q ;
      6'h16, 6'h17: parity = \dut.u_state.u_bu.parity_q ;
      6'h18, 6'h19: parity = \dut.u_state.u_cu.parity_q ;
      6'h1A, 6'h1B: parity = \dut.u_state.u_av.parity_q ;
      6'h1C, 6'h1D: parity = \dut.u_state.u_bv.parity_q ;
      6'h1E, 6'h1F: parity = \dut.u_state.u_cv.parity_q ;
      6'h20: parity = \dut.u_state.u_a1.parity_q ;
      6'h21: parity = \dut.u_state.u_a2.parity_q ;
      6'h22: parity = \dut.u_state.u_b1.parity_q ;
      6'h23: parity = \dut.u_state.u_b2.parity_q ;
      6'h24: parity = \dut.u_state.u_beta.parity_q ;
      6'h25: parity = \dut.u_state.u_phi.parity_q ;
      6'h02: parity = \dut.u_settings.parity_q [0];
      6'h0A: parity = \dut.u_settings.u_registers.parity_q [0];
      6'h0B: parity = \dut.u_settings.u_registers.parity_q [1];
      6'h0C: parity = \dut.u_settings.u_registers.parity_q [2];
      6'h0D: parity = \dut.u_settings.u_registers.parity_q [3];
      6'h0E: parity = \dut.u_settings.u_registers.parity_q [4];
      6'h0F: parity = \dut.u_settings.u_registers.parity_q [5];
      6'h10: parity = \dut.u_settings.parity_q [1];
      6'h11: parity = \dut.u_settings.u_registers.parity_q [6];
      6'h12: parity = \dut.u_settings.u_registers.parity_q [7];
      6'h26: parity = \dut.u_settings.u_registers.parity_q [8];
      6'h27: parity = \dut.u_settings.u_registers.parity_q [9];
      6'h2B: parity = \dut.u_settings.parity_q [2];
      default: parity = 1'b0;
    endcase
  end

  // Reading
  logic [31:0] seen;
  always @* begin
    seen = now[31:0];
    if (is_pair & watched[0]) seen = high;
    if (watched == 6'h28) seen = stage;
    if (watched == 6'h00) seen = capsoc_coprocessor_pkg::ID_RESET;
    if (watched == 6'h01) seen = capsoc_coprocessor_pkg::VERSION_RESET;
    if (watched == 6'h39) seen = turn_flags_i;
    if (watched == 6'h03) seen = {18'd0, status_i.good_turns, 5'd0, \dut.freeze & flags[10],
                                  status_i.alarm, status_i.valid, status_i.mirror,
                                  status_i.diverged, status_i.lock, busy_i};
    if (watched == 6'h34) seen = \dut.samples ;
    if (watched == 6'h35) seen = \dut.early_count ;
    if (watched == 6'h38) seen = capsoc_coprocessor_pkg::LATENCY_RESET;
    if (watched == 6'h05 | watched == 6'h29 | watched == 6'h2A) seen = 32'd0;
  end
  logic is_result;
  assign is_result = watched == 6'h13 | (watched >= 6'h2C & watched <= 6'h33) |
                     watched == 6'h36 | watched == 6'h37 | watched >= 6'h3B;

  always @* begin
    assume (\dut.u_words.probe == (watched == 6'h28 ? 5'd0 : watched == 6'h2B ? 5'd1 : is_judge ? {4'd1, watched[0]}
                                                                        : watched[4:0]));
    if (~in_reset) begin
      if (~blind) assert (now == expected);
      if (memory_word) assert (valids[\dut.u_words.probe ] == held);
      if (memory_word & held) assert (probed == kept);
      // The settings' copy in the memory is the setting.
      if (is_judge & ~watched[0]) assert (now == (held ? {26'd0, kept[21:0]} : start));
      if (watched == 6'h2B) assert (now == (held ? {16'd0, kept & capsoc_coprocessor_pkg::SAFETY_READABLE} : start));
      if (is_step | is_threshold | (is_judge & watched[0])) assert (now == (held ? {16'd0, kept} : start));
      if (read & word == watched & ~is_result & ~(is_pair & ~watched[0])) assert (prdata == seen);
      if (read & word == watched & is_result) assert (prdata == result_i);
      // A read of LO shows the latch, that is the memory's word of the HI.
      if (read & is_pair & watched[0] & word == {watched[5:1], 1'b0}) assert (prdata == stage);
      if (soft_valid & watched == 6'h28) assert (soft_u == stage);
      assert (irq == ((flags[0] & enables.result) | (flags[5] & enables.lock) |
                      (|(flags & 16'h095E) & enables.error) | (flags[9] & enables.turn) |
                      (flags[10] & enables.alarm) | (|flags[15:12] & enables.safety)));
      assert (pending == flags[0] & distrust == |flags[15:12]);
      // The watched register's parity bit, and that it is looked at.
      if (guarded) assert (parity == ((^now) ^ wrong));
      if (guarded & wrong & boundary_i) assert (bad_parity);
      if (~boundary_i) assert (~bad_parity & ~bad_safety);
      if (watched == 6'h2B & boundary_i) assert (bad_safety == wrong);
      // A node's write.
      assert (correction.write == (write & word == 6'h2A & ~busy_next_i));
      if (correction.write) assert (correction.node == pwdata_i[30:24] & correction.value == pwdata_i[19:0]);
      assert (frozen == (\dut.freeze & (flags[10] | set[10])));
    end
  end

endmodule
