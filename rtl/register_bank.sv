// Register bank: the APB slave and every register that is not a result (docs/coprocessor.md,
// "Registers").
//
// Latency: a write counts from the edge that ends its access phase; prdata_o is combinational and
// shows the state after the last edge. No wait states, and nothing depends on the setup phase.
// Formats: phase, freq 2^-48 turn; au .. cv s48, Q2.46; a1, a2, b1, b2 Q1.31; beta, phi 2^-32 turn;
// steps u31 and thresholds u32, Q1.31.
module register_bank #(
  parameter int Paper = 0,
  parameter int Block = 1,
  parameter int Harmonics = 1
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  // APB
  input  logic        psel_i,
  input  logic        penable_i,
  input  logic        pwrite_i,
  input  logic [11:0] paddr_i,
  input  logic [31:0] pwdata_i,
  input  logic [3:0]  pstrb_i,
  output logic        pready_o,
  output logic [31:0] prdata_o,
  output logic        pslverr_o,
  output logic        irq_o,
  // Sequencer
  output logic        clear_o,       // CTRL.SRST
  output logic        adc_enable_o,
  output logic        soft_valid_o,  // SOFT_V is written: (soft_u_o, pwdata_i) is a sample
  output logic [31:0] soft_u_o,
  output logic        load_o,        // CMD.LOAD
  input  logic        busy_i,
  input  logic        busy_next_i,   // as this edge leaves it
  input  logic        stream_early_i,
  input  logic        soft_early_i,
  // Settings
  output settings_t   settings_o,
  output correction_t correction_o,
  output logic        frozen_o,      // with what this edge commits
  // State, and what the pipeline writes at a tick's boundary
  output state_t      state_o,
  input  logic        boundary_i,
  input  state_we_t   state_we_i,
  input  state_t      state_i,
  // Results
  input  logic        commit_i,
  input  flags_t      flags_i,
  input  status_t     status_i,
  input  logic [31:0] turn_flags_i,
  output logic [3:0]  result_select_o,
  input  logic [31:0] result_i
);

  // Decoding. An error has no effect and reads 0. A select holds for mapped addresses, and so do the groups.
  capsoc_coprocessor_selects_t select;
  logic mapped, write, read;
  capsoc_coprocessor_selects u_selects (
    .address_i (paddr_i),
    .select_o  (select),
    .mapped_o  (mapped)
  );
  assign write     = psel_i & penable_i & pwrite_i & mapped & (&pstrb_i);
  assign read      = psel_i & penable_i & ~pwrite_i & mapped;
  assign pready_o  = 1'b1;
  assign pslverr_o = psel_i & penable_i & ~(write | read);

  logic is_low, is_high, is_pair, is_step, is_threshold, is_judge, is_soft;
  assign is_low       = select.FREQ_LO | select.PHASE_LO | select.AU_LO | select.BU_LO | select.CU_LO |
                        select.AV_LO | select.BV_LO | select.CV_LO;
  assign is_high      = select.FREQ_HI | select.PHASE_HI | select.AU_HI | select.BU_HI | select.CU_HI |
                        select.AV_HI | select.BV_HI | select.CV_HI;
  assign is_pair      = is_low | is_high;
  assign is_step      = select.STEP_AU | select.STEP_BU | select.STEP_CU |
                        select.STEP_AV | select.STEP_BV | select.STEP_CV;
  assign is_threshold = select.LOCK_THRESHOLD | select.DIVERGE_THRESHOLD;
  assign is_judge     = select.JUDGE | select.TURN_LIMIT;
  assign is_soft      = select.SOFT_U | select.SOFT_V;

  logic write_ctrl, write_cmd, clear_counters, zero_phase;
  assign write_ctrl     = write & select.CTRL;
  assign write_cmd      = write & select.CMD;
  assign clear_o        = write_ctrl & pwdata_i[capsoc_coprocessor_pkg::CTRL_SRST_LSB];
  assign load_o         = write_cmd & pwdata_i[capsoc_coprocessor_pkg::CMD_LOAD_LSB];
  assign clear_counters = write_cmd & pwdata_i[capsoc_coprocessor_pkg::CMD_CLEAR_LSB];
  assign zero_phase     = write_cmd & pwdata_i[capsoc_coprocessor_pkg::CMD_PHASE0_LSB];
  assign soft_valid_o   = write & select.SOFT_V;

  // Steps of 1.0 or more and negative amplitudes are refused.
  logic beyond, reserved_ref;
  assign beyond = pwdata_i[31] & (is_step | select.A1 | select.A2);

  // The correction's nodes change between samples only.
  localparam int HasHarmonics = Paper == 0 && Harmonics != 0 ? 1 : 0;
  logic correction_refused;
  assign correction_refused = write & select.CORRECTION & (busy_next_i | HasHarmonics == 0);
  assign correction_o.write = write & select.CORRECTION & ~correction_refused;
  assign correction_o.node  = pwdata_i[30:24];
  assign correction_o.value = pwdata_i[19:0];

  // Words of the memory stand at their own address, SOFT_U at 0, JUDGE and TURN_LIMIT at 2 and 3. The
  // word of a LO is its stage, the one of a HI its read latch: a write of LO and a read of HI fill
  // their own word, a write of HI and a read of LO take the other's, which the write leaves at 0.
  localparam logic [31:0] MemoryWords = 32'hFFF6_FFCD;
  logic        word_we, word_valid;
  logic [4:0]  word_address, word_source;
  logic [31:0] word_data, word_read, pair_high, pair_low;
  assign word_address = paddr_i[6:2] & {5{~is_soft}} & {2'b11, ~is_judge, 2'b11};
  assign word_source  = word_address ^ {4'd0, is_pair};
  assign word_we      = (read & is_high) | (write & is_low) |
                        (write & (is_step | is_threshold | is_judge) & ~beyond) |
                        (write & is_soft & ~soft_valid_o) | (write & is_high);
  word_memory #(
    .Used (MemoryWords)
  ) u_words (
    .clk_i, .rst_ni,
    .clear_i (clear_o),
    .we_i    (word_we),
    .waddr_i (word_address ^ {4'd0, pwrite_i & is_high}),
    .wdata_i (pwrite_i ? pwdata_i & {32{~is_high}} : pair_low),
    .raddr_i (word_source),
    .valid_o (word_valid),
    .rdata_o (word_read)
  );
  assign word_data = word_read & {32{word_valid}};
  assign soft_u_o  = word_data;

  // Registers
  logic      freeze;
  enables_t  enables;
  settings_t settings;
  setting_registers #(
    .Block (Paper == 0 && Block != 0 ? 1 : 0),
    .Harmonics (HasHarmonics)
  ) u_settings (
    .clk_i, .rst_ni,
    .clear_i       (clear_o),
    .write_i       (write & ~(is_step & beyond)),
    .select_i      (select),
    .pwdata_i,
    .reserved_o    (reserved_ref),
    .freeze_o      (freeze),
    .enables_o     (enables),
    .adc_enable_o,
    .settings_o    (settings)
  );
  assign settings_o = settings;

  state_registers #(
    .Paper (Paper)
  ) u_state (
    .clk_i, .rst_ni,
    .clear_i       (clear_o),
    .write_i       (write & ~beyond),
    .zero_phase_i  (zero_phase),
    .select_i      (select),
    .pwdata_i,
    .staged_low_i  (word_data),
    .pair_high_o   (pair_high),
    .pair_low_o    (pair_low),
    .boundary_i, .state_we_i, .state_i, .state_o
  );

  logic       commit;
  logic [11:0] events, flags;
  assign commit = commit_i & boundary_i;
  assign events = {{flags_i.unsettled, flags_i.alarm, flags_i.turn} & {3{commit}},
                   (write & beyond) | reserved_ref | correction_refused,
                   {flags_i.mirrorchg, flags_i.diverged, flags_i.lockchg} & {3{commit}},
                   stream_early_i | soft_early_i,
                   {flags_i.zero, flags_i.sat, flags_i.clip} & {3{commit}}, commit};
  flag_register u_flags (
    .clk_i, .rst_ni,
    .clear_i      (clear_o),
    .set_i        (events),
    .write_i      (write & select.FLAGS),
    .write_data_i (pwdata_i[11:0]),
    .enables_i    (enables),
    .flags_o      (flags),
    .irq_o
  );

  localparam int AlarmFlag = capsoc_coprocessor_pkg::FLAGS_ALARM_LSB;
  assign frozen_o = freeze & (flags[AlarmFlag] | events[AlarmFlag]);

  logic [31:0] samples, early_count;
  sample_counters u_counters (
    .clk_i, .rst_ni,
    .clear_i       (clear_o | clear_counters),
    .commit_i      (commit),
    .stream_early_i, .soft_early_i,
    .samples_o     (samples),
    .early_count_o (early_count)
  );

  // Reading: two levels of choices, the narrow words among them. A number's bits are the registers that have
  // them: a multiplexer by number takes less than one by selects, and one of three words (numbers 0 to 2) half
  // of one of four. What is not mapped has number 0 everywhere: the narrow words, of which none is selected.
  // Results: results_memory.sv.
  assign result_select_o[0] = select.RAW_V | select.CAL_C | select.ERR_U | select.RESIDUE | select.AMPLITUDE |
                              select.RADIUS_MAX | select.WINDING | select.TURN_DET;
  assign result_select_o[1] = select.CAL_S | select.CAL_C | select.ERR_V | select.RESIDUE |
                              select.ERROR_AVERAGE | select.RADIUS_MAX | select.TURN_SAMPLES | select.TURN_DET;
  assign result_select_o[2] = select.ANGLE | select.ERR_U | select.ERR_V | select.RESIDUE |
                              select.RESIDUE_MAX | select.WINDING | select.TURN_SAMPLES | select.TURN_DET;
  assign result_select_o[3] = select.REF_PHASE | select.AMPLITUDE | select.ERROR_AVERAGE | select.RADIUS_MAX |
                              select.RESIDUE_MAX | select.WINDING | select.TURN_SAMPLES | select.TURN_DET;

  logic        is_memory, is_result;
  logic [1:0]  column, row, kind;
  logic [31:0] group, narrow, stored, status, ctrl, loop;
  assign is_memory = is_pair | is_step | is_threshold | is_judge | is_soft;
  assign is_result = select.RAW_U | select.RAW_V | select.CAL_S | select.CAL_C | select.ANGLE | select.AMPLITUDE |
                     select.REF_PHASE | select.ERR_U | select.ERR_V | select.ERROR_AVERAGE | select.RESIDUE |
                     select.RADIUS_MAX | select.RESIDUE_MAX | select.WINDING | select.TURN_SAMPLES | select.TURN_DET;
  assign column    = {select.A2 | select.BETA | select.EARLY_COUNT, select.A1 | select.B2 | select.SAMPLES} & {2{mapped}};
  assign row       = {select.PHI | select.SAMPLES | select.EARLY_COUNT, select.B1 | select.B2 | select.BETA} & {2{mapped}};
  assign kind      = {is_result | (is_memory & ~is_high), is_result | is_high} & {2{mapped}};
  assign ctrl         = {18'd0, settings.correct, enables, settings.guard, settings.block, freeze, adc_enable_o, settings.source, settings.calib,
                         settings.demod};
  assign loop         = {19'd0, settings.ki, 3'd0, settings.kp};
  assign status       = {18'd0, status_i.good_turns, 3'd0, Paper != 0, 1'b0, freeze & flags[AlarmFlag],
                         status_i.alarm, status_i.valid, status_i.mirror, status_i.diverged, status_i.lock,
                         busy_i};

  logic [31:0] a1, a2, b1, b2, beta, phi;
  assign {a1, a2, b1, b2, beta, phi} = state_o.parameters;
  always_comb begin
    case (row)
      2'd0:
        case (column)
          2'd0:    group = narrow;
          2'd1:    group = a1;
          default: group = a2;
        endcase
      2'd1:
        case (column)
          2'd0:    group = b1;
          2'd1:    group = b2;
          default: group = beta;
        endcase
      default:
        case (column)
          2'd0:    group = phi;
          2'd1:    group = samples;
          default: group = early_count;
        endcase
    endcase
  end
  capsoc_coprocessor_selects_t shown;
  logic unused_shown;  // of the wide registers
  assign shown = select & {$bits(select){mapped}};
  assign unused_shown = ^shown;
  assign narrow = (capsoc_coprocessor_pkg::ID_RESET & {32{shown.ID}}) |
                  (capsoc_coprocessor_pkg::VERSION_RESET & {32{shown.VERSION}}) |
                  (ctrl & {32{shown.CTRL}}) | (status & {32{shown.STATUS}}) |
                  ({20'd0, flags} & {32{shown.FLAGS}}) | (loop & {32{shown.LOOP}}) |
                  (capsoc_coprocessor_pkg::LATENCY_RESET & {32{shown.LATENCY}}) |
                  (turn_flags_i & {32{shown.TURN_FLAGS}});

  // A setting that was never written reads its reset value; TURN_LIMIT's is 0.
  localparam logic [31:0] JudgeReset = capsoc_coprocessor_pkg::JUDGE_RESET;
  always_comb begin
    stored = word_data;
    if (~word_valid & is_step) stored = capsoc_coprocessor_pkg::STEP_AU_RESET;
    if (~word_valid & is_threshold) begin
      stored = select.LOCK_THRESHOLD ? capsoc_coprocessor_pkg::LOCK_THRESHOLD_RESET
                         : capsoc_coprocessor_pkg::DIVERGE_THRESHOLD_RESET;
    end
    if (select.JUDGE) begin
      stored = {10'd0, word_valid ? word_data[21:0] : JudgeReset[21:0]};
    end
    if (select.SOFT_V) stored = '0;
  end

  always_comb begin
    case (kind)
      2'd0:    prdata_o = group;
      2'd1:    prdata_o = pair_high;
      2'd2:    prdata_o = stored;
      default: prdata_o = result_i;
    endcase
  end

endmodule
