// The paper's arithmetic of stages T0, T1, T3, T4 and of LOAD. Stage T2 is the reference generator.
// Ports as those of precise_core.sv, and the parameters BETA and PHI, which T0 reads (Eq (12)).
//
//   Weights s48 Q2.46, of which bits 46..15 are the paper's Q1.31 words; samples, amplitudes,
//   offsets, errors s32 Q1.31; steps u31 Q1.31; angles u32, 2^-32 turn.
//   LOAD: products s64 Q62 >>r 16 to Q2.46, then >>r 15 and clamped to Q1.31.
// The units and their latencies are those of their own files; everything here is valid in cycle 31
// of its tick, the strobes in the cycles given below. Cost does not count in this arithmetic:
// registers are copied at the tick's start as they are.
module paper_core #(
  parameter int OperandBits = 32,
  parameter int StepShift = 0,
  parameter int PlainArctangent = 0
) (
  input  logic               clk_i,
  input  logic               rst_ni,
  input  logic               boundary_i,
  input  logic        [ 4:0] cycle_i,
  input  logic        [ 4:0] stage_i,
  input  logic        [ 2:0] load_i,
  input  logic        [ 2:1] load_start_i,
  input  logic               update_i,      // T3 writes its weights
  input  logic               keep_u_i,      // with boundary_i: the weights are this tick's results
  input  logic               keep_v_i,
  input  logic signed [31:0] u_i,
  input  logic signed [31:0] v_i,
  input  logic signed [31:0] data_i,
  input  logic signed [31:0] sine_i,
  input  logic signed [31:0] cosine_i,
  input  logic        [30:0] step_au_i,
  input  logic        [30:0] step_bu_i,
  input  logic        [30:0] step_cu_i,
  input  logic        [30:0] step_av_i,
  input  logic        [30:0] step_bv_i,
  input  logic        [30:0] step_cv_i,
  input  logic        [ 2:0] slew_i,
  input  logic        [47:0] au_i,
  input  logic        [47:0] bu_i,
  input  logic        [47:0] cu_i,
  input  logic        [47:0] av_i,
  input  logic        [47:0] bv_i,
  input  logic        [47:0] cv_i,
  input  logic        [31:0] a1_i,
  input  logic        [31:0] a2_i,
  input  logic        [31:0] b1_i,
  input  logic        [31:0] b2_i,
  input  logic        [31:0] beta_i,
  input  logic        [31:0] phi_i,
  input  logic               parameters_we_i,  // with boundary_i: T4's are this tick's results
  output logic               data_v_o,
  output logic               calibrated_valid_o,
  output logic               calibrated_s_o,
  output logic        [31:0] calibrated_o,
  output logic               det_valid_o,
  output logic        [31:0] det_o,
  output logic               amplitude_valid_o,
  output logic               amplitude_late_o,
  output logic        [31:0] amplitude_o,
  output logic               error_valid_o,
  output logic               error_v_o,
  output logic signed [31:0] error_o,
  output logic        [31:0] relative_o,
  output logic               zero_o,
  output logic               mirror_o,
  output logic               unsettled1_o,  // T1's arctangent, T4's; valid in cycle 31
  output logic               unsettled4_o,
  output logic        [ 4:0] saturated_o,
  output logic        [47:0] au_o,
  output logic        [47:0] bu_o,
  output logic        [47:0] cu_o,
  output logic        [47:0] av_o,
  output logic        [47:0] bv_o,
  output logic        [47:0] cv_o,
  output logic        [31:0] a1_o,
  output logic        [31:0] a2_o,
  output logic        [31:0] b1_o,
  output logic        [31:0] b2_o,
  output logic        [31:0] beta_o,
  output logic        [31:0] phi_o,
  output logic        [31:0] angle_o
);

  // Registers as they were at the tick's start. A result that T4 writes at that edge counts.
  logic signed [31:0] a1_q, a2_q, b1_q, b2_q;
  logic [31:0] beta_q, phi_q;
  logic signed [47:0] au_q, bu_q, cu_q, av_q, bv_q, cv_q;
  logic [30:0] step_au_q, step_bu_q, step_cu_q, step_av_q, step_bv_q, step_cv_q;
  logic [2:0] slew_q;
  always_ff @(posedge clk_i) begin
    if (boundary_i) begin
      a1_q <= parameters_we_i ? a1_o : a1_i;
      a2_q <= parameters_we_i ? a2_o : a2_i;
      b1_q <= parameters_we_i ? b1_o : b1_i;
      b2_q <= parameters_we_i ? b2_o : b2_i;
      beta_q <= parameters_we_i ? beta_o : beta_i;
      phi_q <= parameters_we_i ? phi_o : phi_i;
      au_q <= keep_u_i ? au_o : au_i;
      bu_q <= keep_u_i ? bu_o : bu_i;
      cu_q <= keep_u_i ? cu_o : cu_i;
      av_q <= keep_v_i ? av_o : av_i;
      bv_q <= keep_v_i ? bv_o : bv_i;
      cv_q <= keep_v_i ? cv_o : cv_i;
      step_au_q <= step_au_i;
      step_bu_q <= step_bu_i;
      step_cu_q <= step_cu_i;
      step_av_q <= step_av_i;
      step_bv_q <= step_bv_i;
      step_cv_q <= step_cv_i;
      slew_q <= slew_i;
    end
  end

  // What a sample keeps for later stages: its words for T3, its angle for T4.
  logic signed [31:0] u1_q, v1_q, u2_q, v2_q, u3_q, v3_q, cal_s1_q, cal_c1_q, cal_s, cal_c;
  logic [31:0] phi1_q, arctangent, arctangent2_q, arctangent3_q, arctangent4_q, magnitude, magnitude2_q;
  always_ff @(posedge clk_i) begin
    if (boundary_i) begin
      {u1_q, v1_q, u2_q, v2_q, u3_q, v3_q} <= {u_i, v_i, u1_q, v1_q, u2_q, v2_q};
      {cal_s1_q, cal_c1_q, phi1_q} <= {cal_s, cal_c, phi_q};
      {arctangent2_q, arctangent3_q, arctangent4_q} <= {arctangent, arctangent2_q, arctangent3_q};
      magnitude2_q <= magnitude;
    end
  end

  logic calibrator_saturated, error_saturated, weights_saturated, parameters_saturated;
  paper_calibrator u_calibrator (
    .clk_i, .rst_ni, .cycle_i,
    .run_i      (stage_i[0]),
    .u_i, .v_i,
    .a1_i       (a1_q),
    .a2_i       (a2_q),
    .b1_i       (b1_q),
    .b2_i       (b2_q),
    .beta_i     (beta_q),
    .cal_s_o    (cal_s),
    .cal_c_o    (cal_c),
    .det_o,
    .mirror_o,
    .saturated_o(calibrator_saturated)
  );
  assign calibrated_valid_o = stage_i[0] && (cycle_i == 5'd13 || cycle_i == 5'd14);
  assign calibrated_s_o = !cycle_i[0];
  assign calibrated_o = calibrated_s_o ? cal_s : cal_c;

  logic arctangent_settled, parameters_settled;
  paper_arctangent #(
    .OperandBits(OperandBits),
    .Plain(PlainArctangent)
  ) u_arctangent (
    .clk_i, .rst_ni, .cycle_i,
    .run_i  (stage_i[1]),
    .y_i    (cal_s1_q),
    .x_i    (cal_c1_q),
    .angle_o(arctangent),
    .magnitude_o(magnitude),
    .settled_o(arctangent_settled)
  );
  assign relative_o = arctangent - phi1_q;
  assign zero_o = cal_s1_q == '0 && cal_c1_q == '0;
  assign angle_o = arctangent4_q;
  assign det_valid_o = stage_i[0] && cycle_i == 5'd6;
  // T1's loop ends with its tick, so its amplitude is T2's to write.
  assign amplitude_valid_o = stage_i[2] && cycle_i == 5'd11;
  assign amplitude_late_o = 1'b1;
  assign amplitude_o = magnitude2_q;
  assign unsettled1_o = !arctangent_settled;
  assign unsettled4_o = !parameters_settled;

  logic signed [31:0] error_u, error_v;
  logic signed [47:0] au_lms, bu_lms, cu_lms, av_lms, bv_lms, cv_lms;
  paper_lms #(
    .StepShift(StepShift)
  ) u_lms (
    .clk_i, .rst_ni, .cycle_i,
    .run_i              (stage_i[3]),
    .u_i                (u3_q),
    .v_i                (v3_q),
    .sine_i, .cosine_i,
    .step_au_i          (step_au_q),
    .step_bu_i          (step_bu_q),
    .step_cu_i          (step_cu_q),
    .step_av_i          (step_av_q),
    .step_bv_i          (step_bv_q),
    .step_cv_i          (step_cv_q),
    .slew_i             (slew_q),
    .au_i               (au_q),
    .bu_i               (bu_q),
    .cu_i               (cu_q),
    .av_i               (av_q),
    .bv_i               (bv_q),
    .cv_i               (cv_q),
    .error_u_o          (error_u),
    .error_v_o          (error_v),
    .au_o               (au_lms),
    .bu_o               (bu_lms),
    .cu_o               (cu_lms),
    .av_o               (av_lms),
    .bv_o               (bv_lms),
    .cv_o               (cv_lms),
    .error_saturated_o  (error_saturated),
    .weights_saturated_o(weights_saturated)
  );
  assign error_valid_o = stage_i[3] && (cycle_i == 5'd20 || cycle_i == 5'd24);
  assign error_v_o = cycle_i[3];
  assign error_o = error_v_o ? error_v : error_u;
  assign data_v_o = 1'b0;

  paper_parameters #(
    .OperandBits(OperandBits),
    .Plain(PlainArctangent)
  ) u_parameters (
    .clk_i, .rst_ni, .cycle_i,
    .run_i      (stage_i[4]),
    .au_i       (au_q),
    .bu_i       (bu_q),
    .av_i       (av_q),
    .bv_i       (bv_q),
    .a1_o, .a2_o, .beta_o, .phi_o,
    .settled_o  (parameters_settled),
    .saturated_o(parameters_saturated)
  );
  assign b1_o = cu_q[46:15];
  assign b2_o = cv_q[46:15];

  logic signed [47:0] load_sine, load_cosine;
  paper_load u_load (
    .second_i       (load_i[2]),
    .amplitude_i    (load_i[2] ? a2_q : a1_q),
    .sine_i, .cosine_i,
    .sine_weight_o  (load_sine),
    .cosine_weight_o(load_cosine)
  );
  assign au_o = load_i[1] ? load_sine : au_lms;
  assign bu_o = load_i[1] ? load_cosine : bu_lms;
  assign cu_o = load_i[1] ? $signed({b1_q[31], b1_q, 15'b0}) : cu_lms;
  assign av_o = load_i[2] ? load_sine : av_lms;
  assign bv_o = load_i[2] ? load_cosine : bv_lms;
  assign cv_o = load_i[2] ? $signed({b2_q[31], b2_q, 15'b0}) : cv_lms;

  logic end_of_tick;  // the units' flags are valid there
  assign end_of_tick = cycle_i == 5'd31;
  assign saturated_o = {5{end_of_tick}} & {stage_i[4] && parameters_saturated,
      stage_i[3] && (error_saturated || (weights_saturated && update_i)), 2'b00,
      stage_i[0] && calibrator_saturated};

  logic unused_bits;
  assign unused_bits = ^data_i ^ load_i[0] ^ (^load_start_i);

endmodule
