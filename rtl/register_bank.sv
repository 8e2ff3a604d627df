// Register bank: the APB slave and every register that is not a result (docs/coprocessor.md,
// "Registers").
//
// Latency: a write counts from the edge that ends its access phase; prdata_o is combinational and
// shows the state after the last edge. No wait states, and nothing depends on the setup phase.
// Formats: phase, freq 2^-48 turn; au .. cv s48, Q2.46; a1, a2, b1, b2 Q1.31; beta, phi 2^-32 turn;
// steps u31 and thresholds u32, Q1.31.
module register_bank #(
  parameter int Paper = 0
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
  input  logic        stream_early_i,
  input  logic        soft_early_i,
  // Settings
  output logic        demod_o,
  output logic        calib_o,
  output logic [1:0]  ref_o,
  output logic [4:0]  kp_o, ki_o,
  output logic [30:0] step_au_o, step_bu_o, step_cu_o, step_av_o, step_bv_o, step_cv_o,
  output logic [31:0] lock_threshold_o, diverge_threshold_o, turn_limit_o,
  output logic [21:0] judge_o,
  output logic        frozen_o,      // with what this edge commits
  // State, and what the pipeline writes at a tick's boundary
  output logic [47:0] phase_o, freq_o, au_o, bu_o, cu_o, av_o, bv_o, cv_o,
  output logic [31:0] a1_o, a2_o, b1_o, b2_o, beta_o, phi_o,
  input  logic        boundary_i,
  input  logic        phase_we_i, freq_we_i, weights_u_we_i, weights_v_we_i, parameters_we_i,
  input  logic [47:0] phase_i, freq_i, au_i, bu_i, cu_i, av_i, bv_i, cv_i,
  input  logic [31:0] a1_i, a2_i, b1_i, b2_i, beta_i, phi_i,
  // Results
  input  logic        commit_i,
  input  logic        flag_clip_i, flag_sat_i, flag_zero_i,
  input  logic        flag_diverged_i, flag_lockchg_i, flag_mirrorchg_i,
  input  logic        flag_turn_i, flag_alarm_i, flag_unsettled_i,
  input  logic        status_lock_i, status_diverged_i, status_mirror_i, status_valid_i,
  input  logic        status_alarm_i,
  input  logic [1:0]  status_good_turns_i,
  input  logic [31:0] turn_flags_i,
  output logic [3:0]  result_select_o,
  input  logic [31:0] result_i
);

  // Decoding. An error has no effect and reads 0. The map has words 00 .. 29, 2C .. 39
  // and 3B .. 3F.
  logic [5:0] word;
  logic       mapped, write, read;
  assign word      = paddr_i[7:2];
  assign mapped    = paddr_i[11:8] == '0 & paddr_i[1:0] == '0 &
                     (~word[5] | word[4:3] == 2'b00 | word[5:1] == 5'h14 | word[5:2] == 4'hB |
                      (word[5:4] == 2'h3 & word != 6'h3A));
  assign write     = psel_i & penable_i & pwrite_i & mapped & (&pstrb_i);
  assign read      = psel_i & penable_i & ~pwrite_i & mapped;
  assign pready_o  = 1'b1;
  assign pslverr_o = psel_i & penable_i & ~(write | read);

  // Words 06 .. 09 and 14 .. 1F are the 48-bit registers, LO even, HI odd; 0A .. 0F the steps; 11
  // and 12 the thresholds; 26 and 27 JUDGE and TURN_LIMIT; 28 and 29 SOFT_U and SOFT_V. Valid for
  // mapped words.
  logic is_coefficient, is_pair, is_high, is_step, is_threshold, is_judge, is_soft;
  assign is_coefficient = word[5:4] == 2'b01 & (word[3] | word[2]);
  assign is_pair        = is_coefficient | word[5:1] == 5'h03 | word[5:1] == 5'h04;
  assign is_high        = word[0];
  assign is_step        = word[5:3] == 3'b001 & (word[2] | word[1]);
  assign is_threshold   = word == 6'h11 | word == 6'h12;
  assign is_judge       = word[5:1] == 5'h13;
  assign is_soft        = word[5:1] == 5'h14;

  logic write_ctrl, write_cmd, clear_counters, zero_phase;
  assign write_ctrl     = write & paddr_i == capsoc_coprocessor_pkg::CTRL_OFFSET;
  assign write_cmd      = write & paddr_i == capsoc_coprocessor_pkg::CMD_OFFSET;
  assign clear_o        = write_ctrl & pwdata_i[capsoc_coprocessor_pkg::CTRL_SRST_LSB];
  assign load_o         = write_cmd & pwdata_i[capsoc_coprocessor_pkg::CMD_LOAD_LSB];
  assign clear_counters = write_cmd & pwdata_i[capsoc_coprocessor_pkg::CMD_CLEAR_LSB];
  assign zero_phase     = write_cmd & pwdata_i[capsoc_coprocessor_pkg::CMD_PHASE0_LSB];
  assign soft_valid_o   = write & paddr_i == capsoc_coprocessor_pkg::SOFT_V_OFFSET;

  // Steps of 1.0 or more and negative amplitudes are refused.
  logic beyond, reserved_ref;
  assign beyond = pwdata_i[31] & (is_step | paddr_i == capsoc_coprocessor_pkg::A1_OFFSET |
                                  paddr_i == capsoc_coprocessor_pkg::A2_OFFSET);

  // Words of the memory stand at their own address, SOFT_U at 0, JUDGE and TURN_LIMIT at 2 and 3. The word of a LO is its stage, the
  // one of a HI its read latch: a write of LO and a read of HI fill their own word, a write of HI
  // and a read of LO take the other's.
  localparam logic [31:0] MemoryWords = 32'hFFF6_FFCD;
  logic        word_we, word_valid;
  logic [4:0]  word_address, word_source;
  logic [31:0] word_data, word_read, pair_high, pair_low;
  assign word_address = word[4:0] & {5{~is_soft}} & {2'b11, ~is_judge, 2'b11};
  assign word_source  = word_address ^ {4'd0, is_pair};
  assign word_we      = (read & is_pair & is_high) | (write & is_pair & ~is_high) |
                        (write & (is_step | is_threshold | is_judge) & ~beyond) |
                        (write & is_soft & ~soft_valid_o);
  word_memory #(
    .Used (MemoryWords)
  ) u_words (
    .clk_i, .rst_ni,
    .clear_i (clear_o),
    .we_i    (word_we),
    .waddr_i (word_address),
    .wdata_i (pwrite_i ? pwdata_i : pair_low),
    .drop_i  (write & is_pair & is_high),
    .raddr_i (word_source),
    .valid_o (word_valid),
    .rdata_o (word_read)
  );
  assign word_data = word_read & {32{word_valid}};
  assign soft_u_o  = word_data;

  // Registers
  logic ie_result, ie_lock, ie_error, ie_turn, ie_alarm, freeze;
  setting_registers u_settings (
    .clk_i, .rst_ni,
    .clear_i       (clear_o),
    .write_i       (write & ~(is_step & beyond)),
    .paddr_i, .pwdata_i,
    .reserved_o    (reserved_ref),
    .ie_result_o   (ie_result),
    .ie_lock_o     (ie_lock),
    .ie_error_o    (ie_error),
    .ie_turn_o     (ie_turn),
    .ie_alarm_o    (ie_alarm),
    .freeze_o      (freeze),
    .judge_o, .turn_limit_o,
    .demod_o, .calib_o, .ref_o, .adc_enable_o,
    .step_au_o, .step_bu_o, .step_cu_o, .step_av_o, .step_bv_o, .step_cv_o,
    .kp_o, .ki_o, .lock_threshold_o, .diverge_threshold_o
  );

  state_registers #(
    .Paper (Paper)
  ) u_state (
    .clk_i, .rst_ni,
    .clear_i       (clear_o),
    .write_i       (write & ~beyond),
    .zero_phase_i  (zero_phase),
    .word_i        (word),
    .pwdata_i,
    .staged_low_i  (word_data),
    .pair_high_o   (pair_high),
    .pair_low_o    (pair_low),
    .boundary_i, .phase_we_i, .freq_we_i, .weights_u_we_i, .weights_v_we_i, .parameters_we_i,
    .phase_i, .freq_i, .au_i, .bu_i, .cu_i, .av_i, .bv_i, .cv_i,
    .a1_i, .a2_i, .b1_i, .b2_i, .beta_i, .phi_i,
    .phase_o, .freq_o, .au_o, .bu_o, .cu_o, .av_o, .bv_o, .cv_o,
    .a1_o, .a2_o, .b1_o, .b2_o, .beta_o, .phi_o
  );

  logic       commit;
  logic [11:0] events, flags;
  assign commit = commit_i & boundary_i;
  assign events = {{flag_unsettled_i, flag_alarm_i, flag_turn_i} & {3{commit}},
                   (write & beyond) | reserved_ref,
                   {flag_mirrorchg_i, flag_diverged_i, flag_lockchg_i} & {3{commit}},
                   stream_early_i | soft_early_i,
                   {flag_zero_i, flag_sat_i, flag_clip_i} & {3{commit}}, commit};
  flag_register u_flags (
    .clk_i, .rst_ni,
    .clear_i      (clear_o),
    .set_i        (events),
    .write_i      (write & paddr_i == capsoc_coprocessor_pkg::FLAGS_OFFSET),
    .write_data_i (pwdata_i[11:0]),
    .ie_result_i  (ie_result),
    .ie_lock_i    (ie_lock),
    .ie_error_i   (ie_error),
    .ie_turn_i    (ie_turn),
    .ie_alarm_i   (ie_alarm),
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

  // Reading: four groups of words, and the narrow ones beside them.
  assign result_select_o = ~word[5] ? 4'd10 : &word[4:3] ? {1'b1, word[2:0]} :
                           word[4] & word[2] ? {3'b100, word[0]} : {1'b0, ~word[2], word[1:0]};

  logic        is_parameter, is_counter, is_memory, is_narrow;
  logic [31:0] group, narrow, settings, status, ctrl;
  assign is_parameter = word[5:3] == 3'h4;
  assign is_counter   = word[5:1] == 5'h1A;
  assign is_memory    = is_pair | is_step | is_threshold | is_judge | is_soft;
  assign is_narrow    = (word[5:3] == 3'h0 & ~(word[2] & word[1])) | word == 6'h10 |
                        word[5:1] == 5'h1C;
  assign ctrl         = {19'd0, ie_alarm, ie_turn, ie_error, ie_lock, ie_result, 2'd0, freeze,
                         adc_enable_o, ref_o, calib_o, demod_o};
  assign status       = {18'd0, status_good_turns_i, 3'd0, Paper != 0, 1'b0,
                         freeze & flags[AlarmFlag], status_alarm_i, status_valid_i, status_mirror_i,
                         status_diverged_i, status_lock_i, busy_i};

  always_comb begin
    case (word)
      6'h00:   narrow = capsoc_coprocessor_pkg::ID_RESET;
      6'h01:   narrow = capsoc_coprocessor_pkg::VERSION_RESET;
      6'h02:   narrow = ctrl;
      6'h03:   narrow = status;
      6'h04:   narrow = {20'd0, flags};
      6'h10:   narrow = {19'd0, ki_o, 3'd0, kp_o};
      6'h38:   narrow = capsoc_coprocessor_pkg::LATENCY_RESET;
      6'h39:   narrow = turn_flags_i;
      default: narrow = '0;
    endcase
    case (is_counter ? {2'b11, word[0]} : word[2:0])
      3'd0:    group = a1_o;
      3'd1:    group = a2_o;
      3'd2:    group = b1_o;
      3'd3:    group = b2_o;
      3'd4:    group = beta_o;
      3'd5:    group = phi_o;
      3'd6:    group = samples;
      default: group = early_count;
    endcase
  end

  // A setting that was never written reads its reset value; TURN_LIMIT's is 0.
  localparam logic [31:0] JudgeReset = capsoc_coprocessor_pkg::JUDGE_RESET;
  always_comb begin
    settings = word_data;
    if (~word_valid & is_step) settings = capsoc_coprocessor_pkg::STEP_AU_RESET;
    if (~word_valid & is_threshold) begin
      settings = word[0] ? capsoc_coprocessor_pkg::LOCK_THRESHOLD_RESET
                         : capsoc_coprocessor_pkg::DIVERGE_THRESHOLD_RESET;
    end
    if (is_judge & ~word[0]) begin
      settings = {10'd0, word_valid ? word_data[21:0] : JudgeReset[21:0]};
    end
    if (is_soft & word[0]) settings = '0;  // SOFT_V
  end

  logic [1:0]  kind;
  logic [31:0] wide;
  assign kind = is_memory ? {1'b0, ~(is_pair & is_high)} : {1'b1, ~(is_parameter | is_counter)};
  always_comb begin
    case (kind)
      2'd0:    wide = pair_high;
      2'd1:    wide = settings;
      2'd2:    wide = group;
      default: wide = result_i;
    endcase
    prdata_o = (wide & {32{mapped & ~is_narrow}}) | (narrow & {32{mapped}});
  end

endmodule
