// Self-calibration coprocessor (docs/coprocessor.md): an APB slave with a sample port.
//
// Latency: a sample is committed 161 cycles after the edge that latches it, up to 31 more if it has
// to wait for a tick boundary. APB: no wait states.
// Formats: sample words Q1.31, two's complement; registers as documented.
// Order at one edge: ends of ticks, starts of ticks, the sample, the register access.
module coprocessor #(
  parameter int Paper         = 0,   // 0: arithmetic `precise`, 1: `paper`
  parameter int OperandBits   = 32,  // paper: width of the arctangent's operands, 2..32
  parameter int ReferenceLead = 0,   // paper: samples by which the reference leads the data
  parameter int StepShift     = 0,   // paper: right shift of the steps, 0..31
  parameter int PlainArctangent = 0  // paper: the arctangent's input as it is
) (
  input  logic        pclk_i,
  input  logic        presetn_i,
  // APB; only 32-bit writes
  input  logic        psel_i,
  input  logic        penable_i,
  input  logic        pwrite_i,
  input  logic [11:0] paddr_i,
  input  logic [31:0] pwdata_i,
  input  logic [3:0]  pstrb_i,
  output logic        pready_o,
  output logic [31:0] prdata_o,
  output logic        pslverr_o,
  // ADC stream
  input  logic        sample_valid_i,
  input  logic [31:0] sample_u_i,
  input  logic [31:0] sample_v_i,
  input  logic        sample_clip_i,
  output logic        sample_ready_o,  // a sample of this interval will be latched
  output logic        irq_o,
  output logic        idle_o           // nothing changes at the coming edge of itself
);

  // Commands of the register bank
  logic        clear, adc_enable, soft_valid, load_command;
  logic [31:0] soft_u;

  // Sequencer
  logic        place_free, stream_early, soft_early, busy, boundary, enter, held_clip;
  logic [4:0]  cycle, stage;
  logic [2:0]  load, load_start;
  logic [31:0] held_u, held_v;

  // Settings and state
  logic        demod, calib, frozen;
  logic [1:0]  ref_source;
  logic [4:0]  kp, ki;
  logic [30:0] step_au, step_bu, step_cu, step_av, step_bv, step_cv;
  logic [31:0] lock_threshold, diverge_threshold, turn_limit;
  logic [21:0] judge;
  logic [47:0] phase, freq, au, bu, cu, av, bv, cv;
  logic [31:0] a1, a2, b1, b2, beta, phi;

  // Updates and results of the datapath
  logic        phase_we, freq_we, weights_u_we, weights_v_we, parameters_we, commit;
  logic [47:0] phase_next, freq_next, au_next, bu_next, cu_next, av_next, bv_next, cv_next;
  logic [31:0] a1_next, a2_next, b1_next, b2_next, beta_next, phi_next;
  logic        flag_clip, flag_sat, flag_zero, flag_diverged, flag_lockchg, flag_mirrorchg;
  logic        flag_turn, flag_alarm, flag_unsettled;
  logic        status_lock, status_diverged, status_mirror, status_valid, status_alarm;
  logic [1:0]  status_good_turns;
  logic [31:0] turn_flags;
  logic [3:0]  result_select;
  logic [31:0] result;

  assign sample_ready_o = adc_enable & place_free;
  assign idle_o         = ~busy;

  sequencer u_sequencer (
    .clk_i          (pclk_i),
    .rst_ni         (presetn_i),
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
    .busy_o         (busy),
    .boundary_o     (boundary),
    .cycle_o        (cycle),
    .enter_o        (enter),
    .stage_o        (stage),
    .load_o         (load),
    .load_start_o   (load_start),
    .held_u_o       (held_u),
    .held_v_o       (held_v),
    .held_clip_o    (held_clip)
  );

  register_bank #(
    .Paper (Paper)
  ) u_register_bank (
    .clk_i               (pclk_i),
    .rst_ni              (presetn_i),
    .psel_i              (psel_i),
    .penable_i           (penable_i),
    .pwrite_i            (pwrite_i),
    .paddr_i             (paddr_i),
    .pwdata_i            (pwdata_i),
    .pstrb_i             (pstrb_i),
    .pready_o            (pready_o),
    .prdata_o            (prdata_o),
    .pslverr_o           (pslverr_o),
    .irq_o               (irq_o),
    .clear_o             (clear),
    .adc_enable_o        (adc_enable),
    .soft_valid_o        (soft_valid),
    .soft_u_o            (soft_u),
    .load_o              (load_command),
    .busy_i              (busy),
    .stream_early_i      (stream_early),
    .soft_early_i        (soft_early),
    .demod_o             (demod),
    .calib_o             (calib),
    .ref_o               (ref_source),
    .kp_o                (kp),
    .ki_o                (ki),
    .step_au_o           (step_au),
    .step_bu_o           (step_bu),
    .step_cu_o           (step_cu),
    .step_av_o           (step_av),
    .step_bv_o           (step_bv),
    .step_cv_o           (step_cv),
    .lock_threshold_o    (lock_threshold),
    .diverge_threshold_o (diverge_threshold),
    .turn_limit_o        (turn_limit),
    .judge_o             (judge),
    .frozen_o            (frozen),
    .phase_o             (phase),
    .freq_o              (freq),
    .au_o                (au),
    .bu_o                (bu),
    .cu_o                (cu),
    .av_o                (av),
    .bv_o                (bv),
    .cv_o                (cv),
    .a1_o                (a1),
    .a2_o                (a2),
    .b1_o                (b1),
    .b2_o                (b2),
    .beta_o              (beta),
    .phi_o               (phi),
    .boundary_i          (boundary),
    .phase_we_i          (phase_we),
    .phase_i             (phase_next),
    .freq_we_i           (freq_we),
    .freq_i              (freq_next),
    .weights_u_we_i      (weights_u_we),
    .au_i                (au_next),
    .bu_i                (bu_next),
    .cu_i                (cu_next),
    .weights_v_we_i      (weights_v_we),
    .av_i                (av_next),
    .bv_i                (bv_next),
    .cv_i                (cv_next),
    .parameters_we_i     (parameters_we),
    .a1_i                (a1_next),
    .a2_i                (a2_next),
    .b1_i                (b1_next),
    .b2_i                (b2_next),
    .beta_i              (beta_next),
    .phi_i               (phi_next),
    .commit_i            (commit),
    .flag_clip_i         (flag_clip),
    .flag_sat_i          (flag_sat),
    .flag_zero_i         (flag_zero),
    .flag_diverged_i     (flag_diverged),
    .flag_lockchg_i      (flag_lockchg),
    .flag_mirrorchg_i    (flag_mirrorchg),
    .status_lock_i       (status_lock),
    .status_diverged_i   (status_diverged),
    .status_mirror_i     (status_mirror),
    .status_valid_i      (status_valid),
    .flag_turn_i         (flag_turn),
    .flag_alarm_i        (flag_alarm),
    .flag_unsettled_i    (flag_unsettled),
    .status_alarm_i      (status_alarm),
    .status_good_turns_i (status_good_turns),
    .turn_flags_i        (turn_flags),
    .result_select_o     (result_select),
    .result_i            (result)
  );

  datapath #(
    .Paper         (Paper),
    .OperandBits   (OperandBits),
    .ReferenceLead (ReferenceLead),
    .StepShift     (StepShift),
    .PlainArctangent (PlainArctangent)
  ) u_datapath (
    .clk_i               (pclk_i),
    .rst_ni              (presetn_i),
    .clear_i             (clear),
    .boundary_i          (boundary),
    .cycle_i             (cycle),
    .enter_i             (enter),
    .stage_i             (stage),
    .load_i              (load),
    .load_start_i        (load_start),
    .held_u_i            (held_u),
    .held_v_i            (held_v),
    .held_clip_i         (held_clip),
    .demod_i             (demod),
    .frozen_i            (frozen),
    .calib_i             (calib),
    .ref_i               (ref_source),
    .kp_i                (kp),
    .ki_i                (ki),
    .step_au_i           (step_au),
    .step_bu_i           (step_bu),
    .step_cu_i           (step_cu),
    .step_av_i           (step_av),
    .step_bv_i           (step_bv),
    .step_cv_i           (step_cv),
    .lock_threshold_i    (lock_threshold),
    .diverge_threshold_i (diverge_threshold),
    .turn_limit_i        (turn_limit),
    .judge_i             (judge),
    .phase_i             (phase),
    .freq_i              (freq),
    .au_i                (au),
    .bu_i                (bu),
    .cu_i                (cu),
    .av_i                (av),
    .bv_i                (bv),
    .cv_i                (cv),
    .a1_i (a1), .a2_i (a2), .b1_i (b1), .b2_i (b2), .beta_i (beta), .phi_i (phi),
    .phase_we_o          (phase_we),
    .phase_o             (phase_next),
    .freq_we_o           (freq_we),
    .freq_o              (freq_next),
    .weights_u_we_o      (weights_u_we),
    .au_o                (au_next),
    .bu_o                (bu_next),
    .cu_o                (cu_next),
    .weights_v_we_o      (weights_v_we),
    .av_o                (av_next),
    .bv_o                (bv_next),
    .cv_o                (cv_next),
    .parameters_we_o     (parameters_we),
    .a1_o (a1_next), .a2_o (a2_next), .b1_o (b1_next), .b2_o (b2_next),
    .beta_o (beta_next), .phi_o (phi_next),
    .commit_o            (commit),
    .flag_clip_o         (flag_clip),
    .flag_sat_o          (flag_sat),
    .flag_zero_o         (flag_zero),
    .flag_diverged_o     (flag_diverged),
    .flag_lockchg_o      (flag_lockchg),
    .flag_mirrorchg_o    (flag_mirrorchg),
    .result_select_i     (result_select),
    .result_o            (result),
    .status_lock_o       (status_lock),
    .status_diverged_o   (status_diverged),
    .status_mirror_o     (status_mirror),
    .status_valid_o      (status_valid),
    .flag_turn_o         (flag_turn),
    .flag_alarm_o        (flag_alarm),
    .flag_unsettled_o    (flag_unsettled),
    .status_alarm_o      (status_alarm),
    .status_good_turns_o (status_good_turns),
    .turn_flags_o        (turn_flags)
  );

endmodule
