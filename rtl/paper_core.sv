// SPDX-License-Identifier: Apache-2.0
// The paper's arithmetic of stages T0, T1, T3, T4 and of LOAD. Stage T2 is the reference generator.
// Ports as those of precise_core.sv; T0 reads the parameters (Eq (12)).
//
//   Weights s48 Q2.46, of which bits 46..15 are the paper's Q1.31 words; samples, amplitudes,
//   offsets, errors s32 Q1.31; steps u31 Q1.31; angles u32, 2^-32 turn.
//   LOAD: products s64 Q62 >>r 16 to Q2.46, then >>r 15 and clamped to Q1.31.
// The units and their latencies are those of their own files; everything here is valid in cycle 31
// of its tick, the strobes in the cycles given below. Cost does not count in this arithmetic:
// registers are copied at the tick's start as they are. Clocks of rest are the arctangents' alone.
// Weights, parameters and steps are copied with one parity bit.
module paper_core #(
  parameter int OperandBits = 32,
  parameter int StepShift = 0,
  parameter int PlainArctangent = 0,
  parameter int IterationClocks = 1,
  parameter int Safety = 1
) (
  input  logic               clk_i,
  input  logic               rst_ni,
  input  tick_t              tick_i,
  input  state_we_t          keep_i,        // with a boundary: weights, parameters are this tick's results
  input  learning_t          learning_i,    // of T3
  input  logic        [47:0] sum_i,
  input  logic signed [31:0] u_i,
  input  logic signed [31:0] v_i,
  input  logic signed [31:0] data_i,
  input  logic signed [31:0] sine_i,
  input  logic signed [31:0] cosine_i,
  input  steps_t             steps_i,
  input  logic        [ 2:0] slew_i,
  input  weights_t           weights_i,
  input  parameters_t        parameters_i,
  input  logic        [31:0] relative_i,    // core_o.relative corrected, in cycle 31
  input  logic               bad_parity_i,  // SAFETY.BAD_PARITY
  output core_t              core_o,
  output weights_t           weights_o,
  output parameters_t        parameters_o,
  output logic               bad_copy_o
);

  logic boundary;
  logic [4:0] cycle, stage;
  logic [2:0] load;
  assign boundary = tick_i.boundary;
  assign cycle = tick_i.cycle;
  assign stage = tick_i.rest ? '0 : tick_i.stage;
  assign load = tick_i.load;

  // Registers as they were at the tick's start. A result that is written at that edge counts.
  parameters_t parameters_q;
  weights_t weights_q;
  steps_t steps_q;
  logic [2:0] slew_q;
  parameters_t parameters;
  weights_t weights;
  logic parity_q, bad_parity_q;
  assign parameters = keep_i.parameters ? parameters_o : parameters_i;
  assign weights.au = keep_i.weights_u ? weights_o.au : weights_i.au;
  assign weights.bu = keep_i.weights_u ? weights_o.bu : weights_i.bu;
  assign weights.cu = keep_i.weights_u ? weights_o.cu : weights_i.cu;
  assign weights.av = keep_i.weights_v ? weights_o.av : weights_i.av;
  assign weights.bv = keep_i.weights_v ? weights_o.bv : weights_i.bv;
  assign weights.cv = keep_i.weights_v ? weights_o.cv : weights_i.cv;
  always_ff @(posedge clk_i) begin
    if (boundary) begin
      parameters_q <= parameters;
      weights_q <= weights;
      steps_q <= steps_i;
      slew_q <= slew_i;
      parity_q <= ^{parameters, weights, steps_i};
      bad_parity_q <= bad_parity_i;
    end
  end
  // A tick that writes weights has a wrong bit with BAD_PARITY, as the ring of the other arithmetic.
  assign bad_copy_o = boundary && Safety != 0 && (^{parameters_q, weights_q, steps_q} ^ parity_q ^
                                                  (bad_parity_q && keep_i.weights_u));

  // What a sample keeps for later stages: its words for T3, its angle for T4.
  logic signed [31:0] u1_q, v1_q, u2_q, v2_q, u3_q, v3_q, cal_s1_q, cal_c1_q, cal_s, cal_c;
  logic [31:0] phi1_q, arctangent, arctangent2_q, arctangent3_q, arctangent4_q, magnitude, magnitude2_q;
  always_ff @(posedge clk_i) begin
    if (boundary) begin
      {u1_q, v1_q, u2_q, v2_q, u3_q, v3_q} <= {u_i, v_i, u1_q, v1_q, u2_q, v2_q};
      {cal_s1_q, cal_c1_q, phi1_q} <= {cal_s, cal_c, parameters_q.phi};
      {arctangent2_q, arctangent3_q, arctangent4_q} <= {arctangent, arctangent2_q, arctangent3_q};
      magnitude2_q <= magnitude;
    end
  end

  logic calibrator_saturated, error_saturated, weights_saturated, parameters_saturated;
  paper_calibrator #(
    .RegisteredTable(IterationClocks - 1)
  ) u_calibrator (
    .clk_i, .rst_ni,
    .cycle_i    (cycle),
    .run_i      (stage[0]),
    .u_i, .v_i,
    .a1_i       (parameters_q.a1),
    .a2_i       (parameters_q.a2),
    .b1_i       (parameters_q.b1),
    .b2_i       (parameters_q.b2),
    .beta_i     (parameters_q.beta),
    .cal_s_o    (cal_s),
    .cal_c_o    (cal_c),
    .det_o      (core_o.det),
    .mirror_o   (core_o.mirror),
    .saturated_o(calibrator_saturated)
  );
  assign core_o.calibrated_valid = stage[0] && (cycle == 5'd13 || cycle == 5'd14);
  assign core_o.calibrated_s = !cycle[0];
  assign core_o.calibrated = cycle[0] ? cal_c : cal_s;

  logic arctangent_settled, parameters_settled;
  paper_arctangent #(
    .OperandBits(OperandBits),
    .Plain(PlainArctangent),
    .IterationClocks(IterationClocks)
  ) u_arctangent (
    .clk_i, .rst_ni,
    .clock_i(tick_i.clock),
    .run_i  (tick_i.stage[1]),
    .y_i    (cal_s1_q),
    .x_i    (cal_c1_q),
    .angle_o(arctangent),
    .magnitude_o(magnitude),
    .settled_o(arctangent_settled)
  );
  assign core_o.relative = arctangent - phi1_q;
  assign core_o.zero = cal_s1_q == '0 && cal_c1_q == '0;
  assign core_o.angle = arctangent4_q;
  assign core_o.det_valid = stage[0] && cycle == 5'd6;
  // T1's loop ends with its tick, so its amplitude is T2's to write.
  assign core_o.amplitude_valid = stage[2] && cycle == 5'd11;
  assign core_o.amplitude_late = 1'b1;
  assign core_o.amplitude = magnitude2_q;
  assign core_o.unsettled1 = !arctangent_settled;
  assign core_o.unsettled4 = !parameters_settled;

  logic signed [31:0] error_u, error_v;
  weights_t lms;
  paper_lms #(
    .StepShift(StepShift)
  ) u_lms (
    .clk_i, .rst_ni,
    .cycle_i    (cycle),
    .run_i              (stage[3]),
    .u_i                (u3_q),
    .v_i                (v3_q),
    .sine_i, .cosine_i,
    .steps_i            (steps_q),
    .slew_i             (slew_q),
    .weights_i          (weights_q),
    .error_u_o          (error_u),
    .error_v_o          (error_v),
    .weights_o          (lms),
    .error_saturated_o  (error_saturated),
    .weights_saturated_o(weights_saturated)
  );
  assign core_o.error_valid = stage[3] && (cycle == 5'd20 || cycle == 5'd24);
  assign core_o.error_v = cycle[3];
  assign core_o.error = cycle[3] ? error_v : error_u;
  assign core_o.data_v = 1'b0;
  assign core_o.weight_valid = 1'b0;
  assign core_o.weight = '0;

  paper_parameters #(
    .OperandBits(OperandBits),
    .Plain(PlainArctangent),
    .IterationClocks(IterationClocks)
  ) u_parameters (
    .clk_i, .rst_ni,
    .clock_i    (tick_i.clock),
    .cycle_i    (cycle),
    .rest_i     (tick_i.rest),
    .run_i      (tick_i.stage[4]),
    .au_i       (weights_q.au),
    .bu_i       (weights_q.bu),
    .av_i       (weights_q.av),
    .bv_i       (weights_q.bv),
    .a1_o       (parameters_o.a1),
    .a2_o       (parameters_o.a2),
    .beta_o     (parameters_o.beta),
    .phi_o      (parameters_o.phi),
    .settled_o  (parameters_settled),
    .saturated_o(parameters_saturated)
  );
  assign parameters_o.b1 = weights_q.cu[46:15];
  assign parameters_o.b2 = weights_q.cv[46:15];

  logic signed [47:0] load_sine, load_cosine;
  paper_load u_load (
    .second_i       (load[2]),
    .amplitude_i    (load[2] ? parameters_q.a2 : parameters_q.a1),
    .sine_i, .cosine_i,
    .sine_weight_o  (load_sine),
    .cosine_weight_o(load_cosine)
  );
  assign weights_o.au = load[1] ? load_sine : lms.au;
  assign weights_o.bu = load[1] ? load_cosine : lms.bu;
  assign weights_o.cu = load[1] ? {parameters_q.b1[31], parameters_q.b1, 15'b0} : lms.cu;
  assign weights_o.av = load[2] ? load_sine : lms.av;
  assign weights_o.bv = load[2] ? load_cosine : lms.bv;
  assign weights_o.cv = load[2] ? {parameters_q.b2[31], parameters_q.b2, 15'b0} : lms.cv;

  logic end_of_tick;  // the units' flags are valid there
  assign end_of_tick = cycle == 5'd31;
  assign core_o.saturated = {5{end_of_tick}} & {stage[4] && parameters_saturated,
      stage[3] && (error_saturated || (weights_saturated && learning_i.update)), 2'b00,
      stage[0] && calibrator_saturated};

  logic unused_bits;
  assign unused_bits = ^{stage[1], data_i, sum_i, relative_i, learning_i, load[0], tick_i.enter, tick_i.load_start, keep_i.phase, keep_i.freq};

endmodule
