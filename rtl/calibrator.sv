// SPDX-License-Identifier: Apache-2.0
// Calibrator, stage T0: the adjugate of the coefficient matrix applied to the sample less its
// offsets. It stands in for Eq (12) and needs no square root, cosine or division.
//
//   weight_q31_i          s34, Q31: place 0 of the ring, >>r 15
//   weight4_i             s34, Q2.32: place 4, the bits that >>r 15 needs
//   difference_i          s34, Q31: du = u - c_u in cycle 2, dv = v - c_v in cycle 6
//   calibrated_o          s32, Q1.31, sat(C >>r 31) in cycle 13, sat(S >>r 31) in cycle 14;
//                         sat(det >>r 31) in cycle 6
//   s_o, c_o              bits 66..30 of S and C, s67 in Q62, shifted left by shift_o until the
//                         larger one fills the word; valid in cycle 31
//   mirror_o              det < 0; valid from cycle 7 on
//
//   det = a_u b_v - a_v b_u;
//   S = +-(b_v du - b_u dv), C = +-(a_u dv - a_v du), exact, - if det < 0
// Operands are chosen in one cycle, multiplied in the next. Cycles (of choice): 0 a_u b_v,
// 4 a_v b_u; 2 du, 6 dv; 8 a_u dv, 9 b_u dv, 11 a_v du, 12 b_v du. Two accumulators take turns:
// each addition goes to the older one and swaps them. From cycle 15 on they are normalised.
module calibrator (
  input  logic               clk_i,
  input  logic               boundary_i,
  input  logic               active_i,     // T0 holds a sample
  input  logic        [ 4:0] cycle_i,
  input  logic signed [33:0] weight_q31_i,
  input  logic signed [33:0] weight4_i,
  input  logic signed [33:0] difference_i,
  output logic               calibrated_valid_o,
  output logic               calibrated_s_o,  // S, else C
  output logic        [31:0] calibrated_o,
  output logic               det_valid_o,     // calibrated_o is det
  output logic               saturated_o,
  output logic               mirror_o,
  output logic        [36:0] s_o,
  output logic        [36:0] c_o,
  output logic        [ 6:0] shift_o,
  output logic               zero_o
);

  logic signed [33:0] a_q, b_q, du_q, dv_q, b_v_or_b_u;
  assign b_v_or_b_u = $signed({weight4_i[33], weight4_i[33:1]}) + $signed({33'b0, weight4_i[0]});

  logic signed [67:0] product;
  multiplier_34x34 u_multiplier (
    .a_i      (a_q),
    .b_i      (b_q),
    .product_o(product)
  );

  logic early, subtract, add, normalising, mirror_q;
  assign early = cycle_i < 5'd8;
  assign normalising = cycle_i >= 5'd15;
  // In cycle 2 nothing is added: the first product of det only changes places.
  assign add = cycle_i == 5'd1 || cycle_i == 5'd2 || cycle_i == 5'd5 || cycle_i == 5'd9 ||
      cycle_i == 5'd10 || cycle_i == 5'd12 || cycle_i == 5'd13;
  assign subtract = (cycle_i == 5'd5 || cycle_i == 5'd10 || cycle_i == 5'd12) ^ mirror_q;

  logic [66:0] x_q, y_q;
  logic [66:0] sum;
  add_subtract #(.Width(67)) u_sum (
    .a_i(y_q), .b_i(product[66:0]), .minus_i(subtract), .carry_i(subtract), .sum_o(sum)
  );

  logic by8, by1, unused_by16, unused_by4;
  normalise_step u_normalise_step (
    .x_i   (x_q[66:50]),
    .y_i   (y_q[66:50]),
    .by16_o(unused_by16),
    .by8_o (by8),
    .by4_o (unused_by4),
    .by1_o (by1)
  );

  // Sum, 8 places or 1: three choices and a common enable make one LUT a bit.
  logic [66:0] x_next, y_next;
  always_comb begin
    if (!normalising) {x_next, y_next} = {sum, x_q};
    else if (by8) {x_next, y_next} = {x_q[58:0], 8'b0, y_q[58:0], 8'b0};
    else {x_next, y_next} = {x_q[65:0], 1'b0, y_q[65:0], 1'b0};
  end

  logic [6:0] shift_q;
  always_ff @(posedge clk_i) begin
    if (boundary_i) mirror_q <= 1'b0;
    else if (active_i && cycle_i == 5'd6) mirror_q <= x_q[66];

    if (boundary_i || cycle_i == 5'd6) begin
      x_q <= '0;
      y_q <= '0;
      shift_q <= '0;
    end else if (active_i && (normalising ? by1 : add)) begin
      x_q <= x_next;
      y_q <= y_next;
      if (normalising) shift_q <= shift_q + {3'b0, by8, 2'b0, !by8};
    end

    if (active_i) begin
      a_q <= weight_q31_i;
      if (early) b_q <= cycle_i[1:0] == 2'd0 ? b_v_or_b_u : '0;
      else b_q <= cycle_i >= 5'd11 ? du_q : dv_q;
      if (cycle_i == 5'd2) du_q <= difference_i;
      if (cycle_i == 5'd6) dv_q <= difference_i;
    end
  end

  logic signed [35:0] rounded;
  logic fits;
  assign rounded = $signed(x_q[66:31]) + $signed({35'b0, x_q[30]});
  assign fits = &rounded[35:31] || ~|rounded[35:31];
  assign calibrated_o = fits ? rounded[31:0] : {rounded[35], {31{~rounded[35]}}};
  assign calibrated_s_o = !cycle_i[0];
  assign calibrated_valid_o = active_i && (cycle_i == 5'd13 || cycle_i == 5'd14);
  assign det_valid_o = active_i && cycle_i == 5'd6;
  assign saturated_o = calibrated_valid_o && !fits;

  assign mirror_o = mirror_q;
  assign s_o = x_q[66:30];
  assign c_o = y_q[66:30];
  assign shift_o = shift_q;
  assign zero_o = by1;

  logic unused_bits;
  assign unused_bits = product[67];

endmodule
