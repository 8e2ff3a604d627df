// Datapath of the coprocessor: the arithmetic of the five stages between the registers, and the words
// and tags that travel with the samples. docs/coprocessor.md has every format and rounding rule.
//
//   T0 calibrator, T1 polar unit, T3 LMS demodulator, T4 polar unit; LOAD: precise_core or paper_core
//   T2 reference generator, error average, turn judge, results: the same for both arithmetics
//
// A tick is cycles 0 to 31; boundary_i is 1 in the interval whose end begins a tick. Registers are
// read at that edge, as the bank has them in the interval, or as a stage writes them at its end:
// outputs with a write enable hold in the interval with boundary_i. Weights Q2.46, phase and
// frequency 2^-48 turn, sample, amplitudes and offsets Q1.31, angles 2^-32 turn.
module datapath #(
  parameter int Paper = 0,
  parameter int OperandBits = 32,    // paper: of the PI arctangent's multipliers
  parameter int ReferenceLead = 0,   // paper: samples by which the reference leads its data
  parameter int StepShift = 0,       // paper: right shift of the step behind its register
  parameter int PlainArctangent = 0  // paper: the arctangent's input as it is
) (
  input  logic               clk_i, rst_ni, clear_i, boundary_i,
  input  logic [4:0]         cycle_i,
  input  logic               enter_i,
  input  logic [4:0]         stage_i,
  input  logic [2:0]         load_i, load_start_i,
  input  logic signed [31:0] held_u_i, held_v_i,
  input  logic               held_clip_i, demod_i, frozen_i, calib_i,
  input  logic [1:0]         ref_i,
  input  logic [4:0]         kp_i, ki_i,
  input  logic [30:0]        step_au_i, step_bu_i, step_cu_i, step_av_i, step_bv_i, step_cv_i,
  input  logic [31:0]        lock_threshold_i, diverge_threshold_i, turn_limit_i,
  input  logic [21:0]        judge_i,
  input  logic [47:0]        phase_i, freq_i, au_i, bu_i, cu_i, av_i, bv_i, cv_i,
  input  logic [31:0]        a1_i, a2_i, b1_i, b2_i, beta_i, phi_i,
  output logic               phase_we_o,
  output logic [47:0]        phase_o,
  output logic               freq_we_o,
  output logic [47:0]        freq_o,
  output logic               weights_u_we_o,
  output logic [47:0]        au_o, bu_o, cu_o,
  output logic               weights_v_we_o,
  output logic [47:0]        av_o, bv_o, cv_o,
  output logic               parameters_we_o,
  output logic [31:0]        a1_o, a2_o, b1_o, b2_o, beta_o, phi_o,
  output logic               commit_o, flag_clip_o, flag_sat_o, flag_zero_o, flag_diverged_o,
  output logic               flag_lockchg_o, flag_mirrorchg_o, flag_turn_o, flag_alarm_o, flag_unsettled_o,
  input  logic [3:0]         result_select_i,
  output logic [31:0]        result_o,
  output logic               status_lock_o, status_diverged_o, status_mirror_o, status_valid_o,
  output logic               status_alarm_o,
  output logic [1:0]         status_good_turns_o,
  output logic [31:0]        turn_flags_o
);

  // The sample of T0; its words go to memory in the tick's first two cycles.
  logic signed [31:0] u_q, v_q;
  always_ff @(posedge clk_i) begin
    if (enter_i && boundary_i) begin
      u_q <= held_u_i;
      v_q <= held_v_i;
    end
  end

  logic hold_weights, update_q, demod4_q;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      update_q <= 1'b0;
      demod4_q <= 1'b0;
    end else if (boundary_i) begin
      update_q <= demod_i && !frozen_i && !hold_weights;
      demod4_q <= demod_i;
    end
  end
  assign weights_u_we_o = boundary_i && ((stage_i[3] && update_q) || load_i[1]);
  assign weights_v_we_o = boundary_i && ((stage_i[3] && update_q) || load_i[2]);
  assign parameters_we_o = commit_o && demod4_q;

  logic [31:0] relative, residue, reference_phase, phi_now;
  logic signed [31:0] sine, cosine;
  logic zero, mirror, turn, unsettled1, unsettled4;
  logic [4:0] saturated;
  logic [4:0] core_saturated;
  // T4 of the last sample may end where a LOAD begins.
  assign phi_now = parameters_we_o ? phi_o : phi_i;
  reference_generator #(
    .Paper(Paper),
    .ReferenceLead(ReferenceLead)
  ) u_reference_generator (
    .clk_i, .rst_ni, .boundary_i, .cycle_i,
    .start_i          (stage_i[1]),
    .active_i         (stage_i[2]),
    .load_start_i     (load_start_i[0] || load_start_i[1]),
    .load_active_i    (load_i[0] || load_i[1]),
    .load_phase_i     (phi_now + (load_start_i[1] ? beta_i : '0)),
    .ref_i, .kp_i, .ki_i, .phase_i, .freq_i,
    .relative_i       (relative),
    .zero_i           (zero),
    .phase_we_o, .phase_o, .freq_we_o, .freq_o,
    .saturated_o      (saturated[2]),
    .hold_weights_o   (hold_weights),
    .turn_o           (turn),
    .reference_phase_o(reference_phase),
    .residue_o        (residue),
    .sine_o           (sine),
    .cosine_o         (cosine)
  );

  logic data_v, calibrated_valid, calibrated_s, det_valid, amplitude_valid, amplitude_late;
  logic error_valid, error_v;
  logic signed [31:0] data, error;
  logic [31:0] calibrated, det, amplitude, angle;
  if (Paper != 0) begin : g_paper
    paper_core #(
      .OperandBits(OperandBits),
      .StepShift(StepShift),
      .PlainArctangent(PlainArctangent)
    ) u_core (
      .rst_ni,
      .parameters_we_i(parameters_we_o),
      .beta_i,
      .phi_i,
      .data_i            (32'd0),
      .clk_i, .boundary_i, .cycle_i, .stage_i, .load_i,
      .load_start_i      (load_start_i[2:1]),
      .update_i          (update_q),
      .keep_u_i          (weights_u_we_o),
      .keep_v_i          (weights_v_we_o),
      .u_i               (u_q),
      .v_i               (v_q),
      .sine_i            (sine),
      .cosine_i          (cosine),
      .step_au_i, .step_bu_i, .step_cu_i, .step_av_i, .step_bv_i, .step_cv_i,
      .slew_i            (judge_i[21:19]),
      .au_i, .bu_i, .cu_i, .av_i, .bv_i, .cv_i, .a1_i, .a2_i, .b1_i, .b2_i,
      .data_v_o          (data_v),
      .calibrated_valid_o(calibrated_valid),
      .calibrated_s_o    (calibrated_s),
      .calibrated_o      (calibrated),
      .det_valid_o       (det_valid),
      .det_o             (det),
      .amplitude_valid_o (amplitude_valid),
      .amplitude_late_o  (amplitude_late),
      .amplitude_o       (amplitude),
      .error_valid_o     (error_valid),
      .error_v_o         (error_v),
      .error_o           (error),
      .relative_o        (relative),
      .zero_o            (zero),
      .mirror_o          (mirror),
      .unsettled1_o      (unsettled1),
      .unsettled4_o      (unsettled4),
      .saturated_o       (core_saturated),
      .angle_o           (angle),
      .au_o, .bu_o, .cu_o, .av_o, .bv_o, .cv_o, .a1_o, .a2_o, .b1_o, .b2_o, .beta_o, .phi_o
    );
    logic unused_data;
    assign unused_data = ^data;
  end else begin : g_precise
    localparam int unused_settings = OperandBits + StepShift + ReferenceLead;
    precise_core u_core (
      .data_i            (data),
      .clk_i, .rst_ni, .boundary_i, .cycle_i, .stage_i, .load_i,
      .load_start_i      (load_start_i[2:1]),
      .update_i          (update_q),
      .keep_u_i          (weights_u_we_o),
      .keep_v_i          (weights_v_we_o),
      .u_i               (u_q),
      .v_i               (v_q),
      .sine_i            (sine),
      .cosine_i          (cosine),
      .step_au_i, .step_bu_i, .step_cu_i, .step_av_i, .step_bv_i, .step_cv_i,
      .slew_i            (judge_i[21:19]),
      .au_i, .bu_i, .cu_i, .av_i, .bv_i, .cv_i, .a1_i, .a2_i, .b1_i, .b2_i,
      .data_v_o          (data_v),
      .calibrated_valid_o(calibrated_valid),
      .calibrated_s_o    (calibrated_s),
      .calibrated_o      (calibrated),
      .det_valid_o       (det_valid),
      .det_o             (det),
      .amplitude_valid_o (amplitude_valid),
      .amplitude_late_o  (amplitude_late),
      .amplitude_o       (amplitude),
      .error_valid_o     (error_valid),
      .error_v_o         (error_v),
      .error_o           (error),
      .relative_o        (relative),
      .zero_o            (zero),
      .mirror_o          (mirror),
      .unsettled1_o      (unsettled1),
      .unsettled4_o      (unsettled4),
      .saturated_o       (core_saturated),
      .angle_o           (angle),
      .au_o, .bu_o, .cu_o, .av_o, .bv_o, .cv_o, .a1_o, .a2_o, .b1_o, .b2_o, .beta_o, .phi_o
    );
  end
  assign saturated[4:3] = core_saturated[4:3];
  assign saturated[1:0] = core_saturated[1:0];

  logic lock, diverged;
  logic [31:0] average;
  error_average u_error_average (
    .clk_i, .rst_ni, .clear_i, .boundary_i,
    .commit_i     (commit_o),
    .error_valid_i(error_valid),
    .error_i      (error),
    .lock_threshold_i, .diverge_threshold_i,
    .average_o    (average),
    .lock_o       (lock),
    .diverged_o   (diverged)
  );

  logic valid, result_any, angle_any, mirror4, turn4, permits;
  logic [2:0] slot0, slot1, slot2, slot3, slot4, result_slot;
  sample_tags u_sample_tags (
    .clk_i, .rst_ni, .clear_i, .boundary_i, .enter_i, .stage_i,
    .clip_i       (held_clip_i),
    .saturated_i  (saturated),
    .mirror_i     (mirror),
    .zero_i       (zero),
    .lock_i       (lock),
    .diverged_i   (diverged),
    .unsettled1_i (unsettled1),
    .turn_i       (turn),
    .unsettled4_i (unsettled4 && demod4_q),
    .permits_i    (permits),
    .calib_i,
    .slot0_o      (slot0),
    .slot1_o      (slot1),
    .slot2_o      (slot2),
    .slot3_o      (slot3),
    .slot4_o      (slot4),
    .mirror4_o    (mirror4),
    .turn4_o      (turn4),
    .commit_o,
    .valid_o      (valid),
    .result_slot_o(result_slot),
    .result_any_o (result_any),
    .angle_any_o  (angle_any),
    .flag_clip_o, .flag_sat_o, .flag_zero_o, .flag_unsettled_o, .flag_diverged_o, .flag_lockchg_o, .flag_mirrorchg_o,
    .status_lock_o, .status_diverged_o, .status_mirror_o, .status_valid_o
  );

  logic quality_we, record_bank, record_any;
  logic [4:0] quality_address;
  logic [31:0] quality;
  turn_judge u_turn_judge (
    .clk_i, .rst_ni, .clear_i, .boundary_i, .cycle_i, .stage_i,
    .slot0_i          (slot0[1:0]),
    .slot1_i          (slot1),
    .slot2_i          (slot2),
    .slot3_i          (slot3[1:0]),
    .slot4_i          (slot4),
    .det_valid_i      (det_valid),
    .det_i            (det),
    .amplitude_valid_i(amplitude_valid),
    .amplitude_late_i (amplitude_late),
    .amplitude_i      (amplitude),
    .residue_i        (residue),
    .average_i        (average),
    .angle_i          (angle[31:2]),
    .commit_i         (commit_o),
    .clip_i           (flag_clip_o),
    .saturated_i      (flag_sat_o),
    .no_angle_i       (flag_zero_o || flag_unsettled_o),
    .mirror_i         (mirror4),
    .turn_i           (turn4),
    .octant_i         (angle[31:29]),
    .ref_i, .judge_i(judge_i[18:0]), .turn_limit_i,
    .write_o          (quality_we),
    .write_address_o  (quality_address),
    .write_data_o     (quality),
    .bank_o           (record_bank),
    .any_o            (record_any),
    .turn_flags_o,
    .good_turns_o     (status_good_turns_o),
    .alarm_o          (status_alarm_o),
    .ended_o          (flag_turn_o),
    .alarm_next_o     (flag_alarm_o),
    .permits_o        (permits)
  );

  logic first, second;
  logic [31:0] stored_result, angle_q;
  assign first = cycle_i == 5'd0;
  assign second = cycle_i == 5'd1;
  results_memory u_results_memory (
    .clk_i,
    .sample_we_i   (stage_i[0] && (first || second || calibrated_valid)),
    .sample_word_i (calibrated_valid ? {1'b1, !calibrated_s} : {1'b0, second}),
    .sample_i      (calibrated_valid ? calibrated : second ? v_q : u_q),
    .sample_slot_i (slot0),
    .error_we_i    ((stage_i[2] && (first || second)) || error_valid),
    .error_word_i  (error_valid ? {error_v, !error_v} : {2{first}}),
    .error_i       (error_valid ? error : first ? residue : reference_phase),
    .error_slot_i  (error_valid ? slot3 : slot2),
    .quality_we_i  (quality_we),
    .quality_address_i(quality_address),
    .quality_i     (quality),
    .bank_i        (record_bank),
    .data_v_i      (data_v),
    .data_slot_i   (slot3),
    .data_o        (data),
    .select_i      (result_select_i),
    .slot_i        (result_slot),
    .result_o      (stored_result)
  );

  // ANGLE keeps its word while there is no valid one.
  always_ff @(posedge clk_i) begin
    if (commit_o && valid) angle_q <= angle;
  end
  assign result_o = result_select_i == 4'd4 ? (angle_any ? angle_q : '0) :
                    (result_select_i > 4'd10 ? record_any : result_any) ? stored_result : '0;

  logic unused_t2;  // T2 is not the core's
  assign unused_t2 = core_saturated[2];

endmodule
