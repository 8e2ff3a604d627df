// The precise arithmetic of stages T0, T1, T3, T4 and of LOAD: weights, calibrator, polar unit, LMS
// demodulator. Stage T2 is the reference generator. paper_core.sv has the same ports.
//
//   u_i, v_i             s32, Q1.31: T0's sample; data_i: T3's, u or v as data_v_o asks for
//   sine_i, cosine_i     s32, Q1.31: T3's reference, or LOAD's rotation
//   registers            as in the bank; copied here at the tick's start
//   calibrated, det, amplitude, error   words, s32, Q1.31, each valid in the cycle of its strobe; the
//                        amplitude is T1's, or T2's if late
//   unsettled1_o, unsettled4_o     the arctangents of T1, T4 have not converged; valid in cycle 31
//   relative_o, zero_o, mirror_o   valid in cycle 31 of T1, T1, T0; angle 2^-32 turn
//   weights, parameters, angle_o   valid in cycle 31 of T3 (or L1, L2), T4, T4
//   saturated_o[s]       stage s loses high bits in this cycle
module precise_core (
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
  output logic               unsettled1_o,
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

  logic active;
  assign active = |stage_i || |load_i;

  logic turn, weight_valid, weight_saturated, replace;
  logic signed [47:0] weight;
  assign replace = weight_valid && (update_i || |load_i);
  weight_ring u_weight_ring (
    .clk_i,
    .boundary_i,
    .active_i (active),
    .cycle_i,
    .keep_u_i,
    .keep_v_i,
    .load_u_i (load_start_i[1]),
    .load_v_i (load_start_i[2]),
    .b1_i,
    .b2_i,
    .au_i,
    .bu_i,
    .cu_i,
    .av_i,
    .bv_i,
    .cv_i,
    .replace_i(replace),
    .word_i   (weight),
    .turn_o   (turn),
    .place0_o (au_o),
    .place1_o (bu_o),
    .place2_o (cu_o),
    .place3_o (av_o),
    .place4_o (bv_o),
    .place5_o (cv_o)
  );

  logic signed [33:0] weight_q31;
  assign weight_q31 = $signed({au_o[47], au_o[47:15]}) + $signed({33'b0, au_o[14]});

  // Data less the offset that is at place 0, T0's in cycles 2 and 6 and T3's in cycles 3 and 7:
  // floor((d 2^15 - W + 2^14 - 1) / 2^15) = d - W >>r 15.
  logic signed [31:0] data;
  logic signed [49:0] difference;
  assign data_v_o = cycle_i[2];
  assign data = cycle_i[0] ? data_i : cycle_i[2] ? v_i : u_i;
  assign difference = $signed({{3{data[31]}}, data, 15'h3FFF}) - $signed({{2{au_o[47]}}, au_o});

  logic [36:0] s, c;
  logic [6:0] shift;
  logic zero, calibrator_saturated, t1_saturated, t4_saturated, error_saturated;
  calibrator u_calibrator (
    .clk_i,
    .boundary_i,
    .active_i    (stage_i[0]),
    .cycle_i,
    .weight_q31_i(weight_q31),
    .weight4_i   (bv_o[47:14]),
    .difference_i(difference[48:15]),
    .calibrated_valid_o,
    .calibrated_s_o,
    .calibrated_o,
    .det_valid_o,
    .saturated_o (calibrator_saturated),
    .mirror_o,
    .s_o         (s),
    .c_o         (c),
    .shift_o     (shift),
    .zero_o      (zero)
  );

  logic [31:0] psi;
  polar_unit u_polar_unit (
    .clk_i,
    .boundary_i,
    .active_i      (active),
    .t1_active_i   (stage_i[1]),
    .t4_active_i   (stage_i[4]),
    .cycle_i,
    .s_i           (s),
    .c_i           (c),
    .shift_i       (shift),
    .zero_i        (zero),
    .weight3_i     (av_o),
    .weight4_i     (bv_o),
    .weight5_i     (cv_o),
    .relative_o,
    .zero_o,
    .amplitude_valid_o,
    .amplitude_o,
    .a1_o,
    .a2_o,
    .phi_o,
    .psi_o         (psi),
    .t1_saturated_o(t1_saturated),
    .t4_saturated_o(t4_saturated)
  );
  assign beta_o = psi - phi_o;

  lms_demodulator u_lms_demodulator (
    .clk_i,
    .rst_ni,
    .boundary_i,
    .active_i          (stage_i[3] || |load_i[2:1]),
    .cycle_i,
    .load_u_i          (load_i[1]),
    .load_v_i          (load_i[2]),
    .load_u_start_i    (load_start_i[1]),
    .load_v_start_i    (load_start_i[2]),
    .a1_i              (a1_i[30:0]),
    .a2_i              (a2_i[30:0]),
    .step_au_i,
    .step_bu_i,
    .step_cu_i,
    .step_av_i,
    .step_bv_i,
    .step_cv_i,
    .slew_i,
    .weight_i          (au_o),
    .weight_q31_i      (weight_q31),
    .difference_i      (difference[48:15]),
    .sine_i,
    .cosine_i,
    .error_valid_o,
    .error_o,
    .error_saturated_o (error_saturated),
    .weight_valid_o    (weight_valid),
    .weight_o          (weight),
    .weight_saturated_o(weight_saturated)
  );
  assign error_v_o = cycle_i[3];

  // The amplitude is written in T1; this arithmetic's angles always converge.
  assign det_o = calibrated_o;
  assign amplitude_late_o = 1'b0;
  assign unsettled1_o = 1'b0;
  assign unsettled4_o = 1'b0;

  // Offsets: c_u passes place 0 in cycle 3, c_v in cycle 7.
  logic [31:0] offset, b1_q, b2_q;
  logic offset_fits, offset_taken;
  assign offset_fits = weight_q31[33] == weight_q31[31] && weight_q31[32] == weight_q31[31];
  assign offset = offset_fits ? weight_q31[31:0] : {weight_q31[33], {31{~weight_q31[33]}}};
  assign offset_taken = stage_i[4] && (cycle_i == 5'd3 || cycle_i == 5'd7);

  // The angle of T1 waits for the phi of its sample's T4.
  logic [31:0] relative2_q, relative3_q, relative4_q;
  always_ff @(posedge clk_i) begin
    if (offset_taken && !cycle_i[2]) b1_q <= offset;
    if (offset_taken && cycle_i[2]) b2_q <= offset;
    if (boundary_i) begin
      relative2_q <= relative_o;
      relative3_q <= relative2_q;
      relative4_q <= relative3_q;
    end
  end
  assign b1_o = b1_q;
  assign b2_o = b2_q;
  assign angle_o = relative4_q + phi_o;

  assign saturated_o = {t4_saturated || (offset_taken && !offset_fits),
                        error_saturated || (weight_saturated && replace && turn),
                        1'b0, t1_saturated, calibrator_saturated};

  // Amplitudes are not negative; the difference is s34.
  logic unused_bits;
  assign unused_bits = a1_i[31] ^ a2_i[31] ^ difference[49] ^ (^difference[14:0]);

endmodule
