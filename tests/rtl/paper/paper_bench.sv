// The units of the paper arithmetic side by side on common inputs, for tests: one Verilated model
// instead of six. Ports: those of the units, with the unit's name in front where two would clash.
module paper_bench (
  input  logic               clk_i,
  input  logic               rst_ni,
  input  logic               run_i,
  input  logic         [5:0] clock_i,  // of a tick of 64, the first half of which is one of 32
  input  logic signed [31:0] u_i,
  input  logic signed [31:0] v_i,
  input  logic signed [31:0] sine_i,
  input  logic signed [31:0] cosine_i,
  input  logic signed [31:0] a1_i,
  input  logic signed [31:0] a2_i,
  input  logic signed [31:0] b1_i,
  input  logic signed [31:0] b2_i,
  input  logic        [31:0] beta_i,
  input  logic        [30:0] step_au_i,
  input  logic        [30:0] step_bu_i,
  input  logic        [30:0] step_cu_i,
  input  logic        [30:0] step_av_i,
  input  logic        [30:0] step_bv_i,
  input  logic        [30:0] step_cv_i,
  input  logic         [2:0] slew_i,
  input  logic signed [47:0] au_i,
  input  logic signed [47:0] bu_i,
  input  logic signed [47:0] cu_i,
  input  logic signed [47:0] av_i,
  input  logic signed [47:0] bv_i,
  input  logic signed [47:0] cv_i,
  // beta_i looked up
  output logic signed [31:0] lookup_sine_o,
  output logic signed [31:0] lookup_cosine_o,
  output logic signed [31:0] cal_s_o,
  output logic signed [31:0] cal_c_o,
  output logic signed [31:0] det_o,
  output logic               mirror_o,
  output logic               calibrator_saturated_o,
  output logic signed [31:0] error_u_o,
  output logic signed [31:0] error_v_o,
  output logic signed [47:0] au_o,
  output logic signed [47:0] bu_o,
  output logic signed [47:0] cu_o,
  output logic signed [47:0] av_o,
  output logic signed [47:0] bv_o,
  output logic signed [47:0] cv_o,
  output logic               error_saturated_o,
  output logic               weights_saturated_o,
  // Step shift 7, the paper's Table 8
  output logic signed [47:0] shifted_au_o,
  output logic signed [47:0] shifted_cv_o,
  output logic signed [31:0] a1_o,
  output logic signed [31:0] a2_o,
  output logic        [31:0] beta_o,
  output logic        [31:0] phi_o,
  output logic               parameters_settled_o,
  output logic               parameters_saturated_o,
  // Arctangents of (u, v) with narrower operands; of 2 and 16 bits, as the paper has them
  output logic        [31:0] angle_2_o,
  output logic        [31:0] magnitude_2_o,
  output logic               settled_2_o,
  output logic        [31:0] angle_16_o,
  output logic        [31:0] magnitude_16_o,
  output logic               settled_16_o,
  output logic        [31:0] angle_18_o,
  output logic        [31:0] magnitude_18_o,
  output logic               settled_18_o,
  output logic        [31:0] angle_19_o,
  output logic        [31:0] magnitude_19_o,
  output logic               settled_19_o,
  // The same of the units with two clocks an iteration, at the end of the tick of 64
  output logic signed [31:0] two_cal_s_o,
  output logic signed [31:0] two_cal_c_o,
  output logic signed [31:0] two_det_o,
  output logic               two_mirror_o,
  output logic               two_calibrator_saturated_o,
  output logic signed [31:0] two_a1_o,
  output logic signed [31:0] two_a2_o,
  output logic        [31:0] two_beta_o,
  output logic        [31:0] two_phi_o,
  output logic               two_parameters_settled_o,
  output logic               two_parameters_saturated_o,
  output logic        [31:0] two_angle_16_o,
  output logic        [31:0] two_magnitude_16_o,
  output logic               two_settled_16_o,
  output logic        [31:0] two_angle_19_o,
  output logic        [31:0] two_magnitude_19_o,
  output logic               two_settled_19_o
);

  // The units with one clock an iteration have their tick in the first half.
  logic [4:0] cycle;
  logic       run;
  assign cycle = clock_i[4:0];
  assign run = run_i && !clock_i[5];

  paper_lookup u_lookup (
    .clk_i, .enable_i(1'b1),
    .angle_i(beta_i),
    .sine_o(lookup_sine_o),
    .cosine_o(lookup_cosine_o)
  );

  paper_calibrator u_calibrator (
    .clk_i, .rst_ni, .run_i(run), .cycle_i(cycle),
    .u_i, .v_i, .a1_i, .a2_i, .b1_i, .b2_i, .beta_i,
    .cal_s_o, .cal_c_o, .det_o, .mirror_o, .saturated_o(calibrator_saturated_o)
  );

  steps_t steps;
  weights_t weights, weights_next, shifted_next;
  assign steps = {step_au_i, step_bu_i, step_cu_i, step_av_i, step_bv_i, step_cv_i};
  assign weights = {au_i, bu_i, cu_i, av_i, bv_i, cv_i};
  assign {au_o, bu_o, cu_o, av_o, bv_o, cv_o} = weights_next;
  assign shifted_au_o = shifted_next.au;
  assign shifted_cv_o = shifted_next.cv;

  paper_lms u_lms (
    .clk_i, .rst_ni, .run_i(run), .cycle_i(cycle),
    .u_i, .v_i, .sine_i, .cosine_i,
    .steps_i(steps), .slew_i, .weights_i(weights), .error_u_o, .error_v_o, .weights_o(weights_next),
    .error_saturated_o, .weights_saturated_o
  );

  paper_lms #(
    .StepShift(7)
  ) u_lms_shifted (
    .clk_i, .rst_ni, .run_i(run), .cycle_i(cycle),
    .u_i, .v_i, .sine_i, .cosine_i,
    .steps_i(steps), .slew_i, .weights_i(weights), .error_u_o(), .error_v_o(), .weights_o(shifted_next),
    .error_saturated_o(), .weights_saturated_o()
  );

  paper_parameters u_parameters (
    .clk_i, .rst_ni, .run_i(run), .clock_i, .cycle_i(cycle), .rest_i(1'b0),
    .au_i, .bu_i, .av_i, .bv_i,
    .a1_o, .a2_o, .beta_o, .phi_o, .settled_o(parameters_settled_o),
    .saturated_o(parameters_saturated_o)
  );

  paper_arctangent #(.OperandBits(2), .Plain(1)) u_arctangent_2 (
    .clk_i, .rst_ni, .run_i(run), .clock_i, .y_i(u_i), .x_i(v_i),
    .angle_o(angle_2_o), .magnitude_o(magnitude_2_o), .settled_o(settled_2_o)
  );
  paper_arctangent #(.OperandBits(16), .Plain(1)) u_arctangent_16 (
    .clk_i, .rst_ni, .run_i(run), .clock_i, .y_i(u_i), .x_i(v_i),
    .angle_o(angle_16_o), .magnitude_o(magnitude_16_o), .settled_o(settled_16_o)
  );
  paper_arctangent #(.OperandBits(18)) u_arctangent_18 (
    .clk_i, .rst_ni, .run_i(run), .clock_i, .y_i(u_i), .x_i(v_i),
    .angle_o(angle_18_o), .magnitude_o(magnitude_18_o), .settled_o(settled_18_o)
  );
  paper_arctangent #(.OperandBits(19)) u_arctangent_19 (
    .clk_i, .rst_ni, .run_i(run), .clock_i, .y_i(u_i), .x_i(v_i),
    .angle_o(angle_19_o), .magnitude_o(magnitude_19_o), .settled_o(settled_19_o)
  );

  // Cycles of the tick of 64, as sequencer.sv has them.
  logic       rest, last;
  logic [4:0] long_cycle;
  assign last = clock_i == 6'd63;
  assign rest = clock_i > 6'd30 && !last;
  assign long_cycle = last ? 5'd31 : rest ? 5'd30 : clock_i[4:0];

  paper_calibrator #(.RegisteredTable(1)) u_two_calibrator (
    .clk_i, .rst_ni, .run_i(run_i && !rest), .cycle_i(long_cycle),
    .u_i, .v_i, .a1_i, .a2_i, .b1_i, .b2_i, .beta_i,
    .cal_s_o(two_cal_s_o), .cal_c_o(two_cal_c_o), .det_o(two_det_o), .mirror_o(two_mirror_o),
    .saturated_o(two_calibrator_saturated_o)
  );
  paper_parameters #(.IterationClocks(2)) u_two_parameters (
    .clk_i, .rst_ni, .run_i, .clock_i, .cycle_i(long_cycle), .rest_i(rest),
    .au_i, .bu_i, .av_i, .bv_i,
    .a1_o(two_a1_o), .a2_o(two_a2_o), .beta_o(two_beta_o), .phi_o(two_phi_o),
    .settled_o(two_parameters_settled_o), .saturated_o(two_parameters_saturated_o)
  );
  paper_arctangent #(.OperandBits(16), .Plain(1), .IterationClocks(2)) u_two_arctangent_16 (
    .clk_i, .rst_ni, .run_i, .clock_i, .y_i(u_i), .x_i(v_i),
    .angle_o(two_angle_16_o), .magnitude_o(two_magnitude_16_o), .settled_o(two_settled_16_o)
  );
  paper_arctangent #(.OperandBits(19), .IterationClocks(2)) u_two_arctangent_19 (
    .clk_i, .rst_ni, .run_i, .clock_i, .y_i(u_i), .x_i(v_i),
    .angle_o(two_angle_19_o), .magnitude_o(two_magnitude_19_o), .settled_o(two_settled_19_o)
  );

endmodule
