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
  // CLIP, SAT, ZERO, DIVERGED, LOCKCHG, MIRRORCHG, TURN, ALARM, UNSETTLED from bit 0
  input  logic [8:0]  flags_i,
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
  logic        demod, calib;
  logic [1:0]  ref_source;

  assign sample_ready_o = adc_enable & place_free;
  assign control_o      = {adc_enable, ref_source, calib, demod};

  sequencer u_sequencer (
    .clk_i, .rst_ni,
    .clear_i        (clear),
    .stream_valid_i (sample_valid_i & adc_enable),
    .stream_u_i     (sample_u_i),
    .stream_v_i     (sample_v_i),
    .stream_clip_i  (sample_clip_i),
    .soft_valid_i   (soft_valid),
    .soft_u_i       (soft_u),
    .soft_v_i       (pwdata_i),
    .load_i         (load_command),
    .place_free_o   (place_free),
    .stream_early_o (stream_early),
    .soft_early_o   (soft_early),
    .busy_o, .boundary_o, .cycle_o, .enter_o, .stage_o, .load_o, .load_start_o,
    .held_u_o, .held_v_o, .held_clip_o
  );

  logic [47:0] unused_pairs;
  logic [31:0] unused_parameters;
  logic [47:0] phase, freq, au, bu, cu, av, bv, cv;
  logic [31:0] a1, a2, b1, b2, beta, phi;
  assign unused_pairs      = phase ^ freq ^ au ^ bu ^ cu ^ av ^ bv ^ cv;
  assign unused_parameters = a1 ^ a2 ^ b1 ^ b2 ^ beta ^ phi;

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
    .stream_early_i   (stream_early),
    .soft_early_i     (soft_early),
    .demod_o          (demod),
    .calib_o          (calib),
    .ref_o            (ref_source),
    .kp_o             (loop_o[4:0]),
    .ki_o             (loop_o[9:5]),
    .step_au_o, .step_bu_o, .step_cu_o, .step_av_o, .step_bv_o, .step_cv_o,
    .lock_threshold_o, .diverge_threshold_o, .frozen_o, .judge_o, .turn_limit_o,
    .phase_o (phase), .freq_o (freq), .au_o (au), .bu_o (bu), .cu_o (cu),
    .av_o (av), .bv_o (bv), .cv_o (cv),
    .a1_o (a1), .a2_o (a2), .b1_o (b1), .b2_o (b2), .beta_o (beta), .phi_o (phi),
    .boundary_i       (boundary_o),
    .phase_we_i       (write_all_i),
    .freq_we_i        (write_all_i),
    .weights_u_we_i   (write_all_i),
    .weights_v_we_i   (write_all_i),
    .parameters_we_i  (write_all_i),
    .phase_i, .freq_i, .au_i, .bu_i, .cu_i, .av_i, .bv_i, .cv_i,
    .a1_i, .a2_i, .b1_i, .b2_i, .beta_i, .phi_i,
    .commit_i         (stage_o[4]),
    .flag_clip_i      (flags_i[0]),
    .flag_sat_i       (flags_i[1]),
    .flag_zero_i      (flags_i[2]),
    .flag_diverged_i  (flags_i[3]),
    .flag_lockchg_i   (flags_i[4]),
    .flag_mirrorchg_i (flags_i[5]),
    .flag_turn_i      (flags_i[6]),
    .flag_alarm_i     (flags_i[7]),
    .flag_unsettled_i (flags_i[8]),
    .status_lock_i    (status_i[0]),
    .status_diverged_i(status_i[1]),
    .status_mirror_i  (status_i[2]),
    .status_valid_i   (status_i[3]),
    .status_alarm_i   (status_i[4]),
    .status_good_turns_i (status_i[6:5]),
    .turn_flags_i,
    .result_select_o, .result_i
  );

endmodule
