// The sequencer and the register bank as the coprocessor connects them, with the datapath's side
// open: the test plays the datapath.
module register_bench #(
  parameter int Paper = 0
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        psel_i,
  input  logic        penable_i,
  input  logic        pwrite_i,
  input  logic [11:0] paddr_i,
  input  logic [31:0] pwdata_i,
  input  logic [3:0]  pstrb_i,
  output logic        pready_o,
  output logic [31:0] prdata_o,
  output logic        pslverr_o,
  input  logic        sample_valid_i,
  input  logic [31:0] sample_u_i,
  input  logic [31:0] sample_v_i,
  input  logic        sample_clip_i,
  output logic        sample_ready_o,
  output logic        irq_o,
  output logic        busy_o,
  // Sequencer
  output logic        boundary_o,
  output logic        enter_o,
  output logic [4:0]  cycle_o,
  output logic [4:0]  stage_o,
  output logic [2:0]  load_o,
  output logic [2:0]  load_start_o,
  output logic [31:0] held_u_o,
  output logic [31:0] held_v_o,
  output logic        held_clip_o,
  // Datapath
  input  logic        write_all_i,
  input  logic [47:0] phase_i, freq_i, au_i, bu_i, cu_i, av_i, bv_i, cv_i,
  input  logic [31:0] a1_i, a2_i, b1_i, b2_i, beta_i, phi_i,
  // CLIP, SAT, ZERO, DIVERGED, LOCKCHG, MIRRORCHG, TURN, ALARM, UNSETTLED, PARITY, MISFIT, JUMP, MISSED from bit 0
  input  logic [12:0] flags_i,
  input  logic [6:0]  status_i,  // LOCK, DIVERGED, MIRROR, VALID, ALARM, GOOD_TURNS from bit 0
  input  logic [31:0] turn_flags_i,
  output logic [3:0]  result_select_o,
  input  logic [31:0] result_i,
  // Settings
  output logic [4:0]  control_o,  // DEMOD, CALIB, REF, ADC from bit 0
  output logic        frozen_o,
  output logic [21:0] judge_o,
  output logic [31:0] turn_limit_o,
  output logic [9:0]  loop_o,     // KP from bit 0, KI from bit 5
  output logic [30:0] step_au_o, step_bu_o, step_cu_o, step_av_o, step_bv_o, step_cv_o,
  output logic [31:0] lock_threshold_o, diverge_threshold_o
);

  logic        clear, adc_enable, soft_valid, load_command, place_free, stream_early, soft_early;
  logic [31:0] soft_u;
  tick_t       tick;
  sample_t     held;
  settings_t   settings;

  // The test has the words of a bundle one by one.
  assign sample_ready_o = adc_enable & place_free;
  assign {boundary_o, enter_o, cycle_o} = {tick.boundary, tick.enter, tick.cycle};
  assign {stage_o, load_o, load_start_o} = {tick.stage, tick.load, tick.load_start};
  assign {held_u_o, held_v_o, held_clip_o} = held;
  assign control_o = {adc_enable, settings.source, settings.calib, settings.demod};
  capsoc_coprocessor_settings_t registers;
  assign registers = settings.registers;
  assign loop_o = {settings.ki, settings.kp};
  assign {step_au_o, step_bu_o, step_cu_o, step_av_o, step_bv_o, step_cv_o} =
      {registers.STEP_AU, registers.STEP_BU, registers.STEP_CU, registers.STEP_AV, registers.STEP_BV, registers.STEP_CV};
  assign lock_threshold_o = registers.LOCK_THRESHOLD;
  assign diverge_threshold_o = registers.DIVERGE_THRESHOLD;
  assign judge_o = registers.JUDGE;
  assign turn_limit_o = registers.TURN_LIMIT;

  logic busy_next, pending, distrust, bad_parity, bad_safety;
  sequencer u_sequencer (
    .clk_i, .rst_ni,
    .clear_i        (clear),
    .stream_valid_i (sample_valid_i & adc_enable),
    .stream_i       ({sample_u_i, sample_v_i, sample_clip_i}),
    .soft_valid_i   (soft_valid),
    .soft_u_i       (soft_u),
    .soft_v_i       (pwdata_i),
    .load_i         (load_command),
    .place_free_o   (place_free),
    .stream_early_o (stream_early),
    .soft_early_o   (soft_early),
    .busy_o,
    .busy_next_o    (busy_next),
    .tick_o         (tick),
    .held_o         (held)
  );

  state_t      state, unused_state;
  correction_t unused_correction;
  weights_t    weights;
  parameters_t parameters;
  assign weights    = {au_i, bu_i, cu_i, av_i, bv_i, cv_i};
  assign parameters = {a1_i, a2_i, b1_i, b2_i, beta_i, phi_i};
  assign state      = {phase_i, freq_i, weights, parameters};

  register_bank #(
    .Paper (Paper)
  ) u_register_bank (
    .clk_i, .rst_ni,
    .psel_i, .penable_i, .pwrite_i, .paddr_i, .pwdata_i, .pstrb_i, .pready_o, .prdata_o, .pslverr_o,
    .irq_o,
    .clear_o          (clear),
    .adc_enable_o     (adc_enable),
    .soft_valid_o     (soft_valid),
    .soft_u_o         (soft_u),
    .load_o           (load_command),
    .busy_i           (busy_o),
    .busy_next_i      (busy_next),
    .stream_early_i   (stream_early),
    .soft_early_i     (soft_early),
    .settings_o       (settings),
    .correction_o     (unused_correction),
    .frozen_o,
    .pending_o        (pending),
    .distrust_o       (distrust),
    .bad_parity_o     (bad_parity),
    .bad_safety_o     (bad_safety),
    .state_o          (unused_state),
    .boundary_i       (boundary_o),
    .state_we_i       ({5{write_all_i}}),
    .state_i          (state),
    .commit_i         (stage_o[4]),
    .flags_i          ({flags_i[12:9], flags_i[8:6], flags_i[5], flags_i[3], flags_i[4], flags_i[2:0]}),
    .status_i,
    .turn_flags_i,
    .result_select_o, .result_i
  );

endmodule
