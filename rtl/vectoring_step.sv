// SPDX-License-Identifier: Apache-2.0
// Micro-rotations 3 n + Offset of the vectoring CORDIC, n = 0..9, combinational: turns (x, y)
// towards the positive x axis.
//
//   x, y s39, z u37 in 2^-37 turn; with i = 3 n + Offset and d = +1 if y >= 0, else -1:
//   x += d (y >>r i); y -= d (x >>r i); z += d A[i]. Shifts are rounded half up.
//   n = 3 thirds_i + rest_i, rest_i 0..2
module vectoring_step #(
  parameter int Offset = 0
) (
  input  logic        [ 1:0] thirds_i,
  input  logic        [ 1:0] rest_i,
  input  logic signed [38:0] x_i,
  input  logic signed [38:0] y_i,
  input  logic        [36:0] z_i,
  output logic signed [38:0] x_o,
  output logic signed [38:0] y_o,
  output logic        [36:0] z_o
);

  logic [36:0] rom;
  always_comb begin
    rom = '0;
    for (int n = 0; n < 10; n++)
      rom |= {thirds_i, rest_i} == {2'(n / 3), 2'(n % 3)} ? cordic_pkg::ANGLE_37[37*(3*n+Offset) +: 37] : '0;
  end

  // One more bit below, which is the one that the rounding looks at. Three choices of two select bits are one LUT
  // of five inputs, half an ALM; of the second level only the lower bits have four.
  logic signed [39:0] x_fixed, y_fixed, x_fine, y_fine, x_shifted, y_shifted;
  assign x_fixed = $signed({x_i, 1'b0}) >>> Offset;
  assign y_fixed = $signed({y_i, 1'b0}) >>> Offset;
  always_comb begin
    case (rest_i)
      2'd0: {x_fine, y_fine} = {x_fixed, y_fixed};
      2'd1: {x_fine, y_fine} = {x_fixed >>> 3, y_fixed >>> 3};
      default: {x_fine, y_fine} = {x_fixed >>> 6, y_fixed >>> 6};
    endcase
    case (thirds_i)
      2'd0: {x_shifted, y_shifted} = {x_fine, y_fine};
      2'd1: {x_shifted, y_shifted} = {x_fine >>> 9, y_fine >>> 9};
      2'd2: {x_shifted, y_shifted} = {x_fine >>> 18, y_fine >>> 18};
      default: {x_shifted, y_shifted} = {x_fine >>> 27, y_fine >>> 27};
    endcase
  end

  // +b or -b with its rounding bit r is (b ^ {s}) + (s ^ r): one adder with a carry.
  logic minus;
  logic [38:0] x_sum, y_sum;
  assign minus = y_i[38];
  add_subtract #(.Width(39)) u_x (
    .a_i(x_i), .b_i(y_shifted[39:1]), .minus_i(minus), .carry_i(minus ^ y_shifted[0]),
    .sum_o(x_sum)
  );
  add_subtract #(.Width(39)) u_y (
    .a_i(y_i), .b_i(x_shifted[39:1]), .minus_i(~minus), .carry_i(~minus ^ x_shifted[0]),
    .sum_o(y_sum)
  );
  add_subtract #(.Width(37)) u_z (
    .a_i(z_i), .b_i(rom), .minus_i(minus), .carry_i(minus), .sum_o(z_o)
  );
  assign x_o = $signed(x_sum);
  assign y_o = $signed(y_sum);

endmodule
