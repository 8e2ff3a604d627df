// SPDX-License-Identifier: Apache-2.0
// The precise arithmetic of stages T0, T1, T3, T4 and of LOAD: weights, calibrator, polar unit, LMS
// demodulator. Stage T2 is the reference generator. paper_core.sv has the same ports.
//
//   u_i, v_i             s32, Q1.31: T0's sample; data_i: T3's, u or v as core_o.data_v asks for
//   sine_i, cosine_i     s32, Q1.31: T3's reference, or LOAD's rotation
//   registers            as in the bank; copied here at the tick's start
//   core_o               coprocessor_types.sv
//   weights_o            valid in cycle 31 of T3 (or L1, L2)
//   parameters_o         valid in cycle 31 of T4
//   bad_copy_o           with a boundary: a bit of the registers' copies changed in the tick that ends
module precise_core #(
  parameter int Safety = 1
) (
  input  logic               clk_i,
  input  logic               rst_ni,
  input  tick_t              tick_i,
  input  state_we_t          keep_i,        // with a boundary: weights, parameters are this tick's results
  input  learning_t          learning_i,    // of T3
  input  logic        [47:0] sum_i,         // block_learning.sv
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

  logic boundary, active;
  logic [4:0] cycle, stage;
  logic [2:0] load;
  assign boundary = tick_i.boundary;
  assign cycle = tick_i.cycle;
  assign stage = tick_i.stage;
  assign load = tick_i.load;
  assign active = |stage || |load;

  // Places of the ring: au is place 0.
  weights_t ring;
  logic turn, weight_valid, weight_saturated, replace;
  logic signed [47:0] weight;
  assign replace = weight_valid && (learning_i.update || learning_i.sum || |load);
  logic bad_parity_q;
  always_ff @(posedge clk_i) if (boundary) bad_parity_q <= bad_parity_i;
  weight_ring #(
    .Safety(Safety)
  ) u_weight_ring (
    .clk_i,
    .boundary_i(boundary),
    .active_i  (active),
    .cycle_i   (cycle),
    .keep_u_i  (keep_i.weights_u),
    .keep_v_i  (keep_i.weights_v),
    .load_u_i  (tick_i.load_start[1]),
    .load_v_i  (tick_i.load_start[2]),
    .from_sums_i(stage[3] && learning_i.from_sums),
    .sum_i,
    .b1_i      (parameters_i.b1),
    .b2_i      (parameters_i.b2),
    .weights_i,
    .replace_i (replace),
    .word_i    (weight),
    .bad_parity_i(bad_parity_q && learning_i.update),
    .bad_o     (bad_copy_o),
    .turn_o    (turn),
    .weights_o (ring)
  );
  assign weights_o = ring;

  logic signed [33:0] weight_q31;
  assign weight_q31 = $signed({ring.au[47], ring.au[47:15]}) + $signed({33'b0, ring.au[14]});

  // Data less the offset that is at place 0, T0's in cycles 2 and 6 and T3's in cycles 3 and 7:
  // floor((d 2^15 - W + 2^14 - 1) / 2^15) = d - W >>r 15.
  logic signed [31:0] data;
  logic signed [49:0] difference;
  assign core_o.data_v = cycle[2];
  assign data = cycle[0] ? data_i : cycle[2] ? v_i : u_i;
  assign difference = $signed({{3{data[31]}}, data, 15'h3FFF}) - $signed({{2{ring.au[47]}}, ring.au});

  logic [31:0] calibrated;
  logic [36:0] s, c;
  logic [6:0] shift;
  logic zero, calibrator_saturated, t1_saturated, t4_saturated, error_saturated;
  calibrator u_calibrator (
    .clk_i,
    .boundary_i  (boundary),
    .active_i    (stage[0]),
    .cycle_i     (cycle),
    .weight_q31_i(weight_q31),
    .weight4_i   (ring.bv[47:14]),
    .difference_i(difference[48:15]),
    .calibrated_valid_o(core_o.calibrated_valid),
    .calibrated_s_o    (core_o.calibrated_s),
    .calibrated_o(calibrated),
    .det_valid_o (core_o.det_valid),
    .saturated_o (calibrator_saturated),
    .mirror_o    (core_o.mirror),
    .s_o         (s),
    .c_o         (c),
    .shift_o     (shift),
    .zero_o      (zero)
  );

  logic [31:0] relative, phi, psi;
  polar_unit u_polar_unit (
    .clk_i,
    .boundary_i    (boundary),
    .t1_active_i   (stage[1]),
    .t4_active_i   (stage[4]),
    .cycle_i       (cycle),
    .s_i           (s),
    .c_i           (c),
    .shift_i       (shift),
    .zero_i        (zero),
    .weight3_i     (ring.av),
    .weight4_i     (ring.bv),
    .weight5_i     (ring.cv),
    .relative_o    (relative),
    .zero_o        (core_o.zero),
    .amplitude_valid_o(core_o.amplitude_valid),
    .amplitude_o   (core_o.amplitude),
    .a1_o          (parameters_o.a1),
    .a2_o          (parameters_o.a2),
    .phi_o         (phi),
    .psi_o         (psi),
    .t1_saturated_o(t1_saturated),
    .t4_saturated_o(t4_saturated)
  );

  lms_demodulator u_lms_demodulator (
    .clk_i,
    .rst_ni,
    .boundary_i        (boundary),
    .active_i          (stage[3] || |load[2:1]),
    .cycle_i           (cycle),
    .load_u_i          (load[1]),
    .load_v_i          (load[2]),
    .load_u_start_i    (tick_i.load_start[1]),
    .load_v_start_i    (tick_i.load_start[2]),
    .a1_i              (parameters_i.a1[30:0]),
    .a2_i              (parameters_i.a2[30:0]),
    .steps_i,
    .slew_i,
    .weight_i          (ring.au),
    .weight_q31_i      (weight_q31),
    .difference_i      (difference[48:15]),
    .sine_i,
    .cosine_i,
    .error_valid_o     (core_o.error_valid),
    .error_o           (core_o.error),
    .error_saturated_o (error_saturated),
    .weight_valid_o    (weight_valid),
    .weight_o          (weight),
    .weight_saturated_o(weight_saturated)
  );
  assign core_o.error_v = cycle[3];
  assign core_o.weight_valid = weight_valid && turn && stage[3];
  assign core_o.weight = weight;

  // The amplitude is written in T1; this arithmetic's angles always converge.
  assign core_o.calibrated = calibrated;
  assign core_o.det = calibrated;
  assign core_o.amplitude_late = 1'b0;
  assign core_o.unsettled1 = 1'b0;
  assign core_o.unsettled4 = 1'b0;

  // Offsets: c_u passes place 0 in cycle 3, c_v in cycle 7.
  logic [31:0] offset, b1_q, b2_q;
  logic offset_fits, offset_taken;
  assign offset_fits = weight_q31[33] == weight_q31[31] && weight_q31[32] == weight_q31[31];
  assign offset = offset_fits ? weight_q31[31:0] : {weight_q31[33], {31{~weight_q31[33]}}};
  assign offset_taken = stage[4] && (cycle == 5'd3 || cycle == 5'd7);

  // The angle of T1 waits for the phi of its sample's T4.
  logic [31:0] relative2_q, relative3_q, relative4_q;
  always_ff @(posedge clk_i) begin
    if (offset_taken && !cycle[2]) b1_q <= offset;
    if (offset_taken && cycle[2]) b2_q <= offset;
    if (boundary) begin
      relative2_q <= relative_i;
      relative3_q <= relative2_q;
      relative4_q <= relative3_q;
    end
  end
  assign parameters_o.b1 = b1_q;
  assign parameters_o.b2 = b2_q;
  assign parameters_o.beta = psi - phi;
  assign parameters_o.phi = phi;
  assign core_o.relative = relative;
  assign core_o.angle = relative4_q + phi;

  assign core_o.saturated = {t4_saturated || (offset_taken && !offset_fits),
                        error_saturated || (weight_saturated && replace && turn),
                        1'b0, t1_saturated, calibrator_saturated};

  // Amplitudes are not negative; the difference is s34. The rest is the other arithmetic's.
  logic unused_bits;
  assign unused_bits = ^{parameters_i.a1[31], parameters_i.a2[31], difference[49], difference[14:0],
                         parameters_i.beta, parameters_i.phi, keep_i.phase, keep_i.freq, keep_i.parameters,
                         tick_i.enter, tick_i.load_start[0], tick_i.clock, tick_i.rest};

endmodule
