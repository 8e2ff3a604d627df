// SPDX-License-Identifier: Apache-2.0
// Magnitude of a vector after the vectoring CORDIC: removes the CORDIC's gain and undoes the normalisation.
//
//   x_i          s39, not negative; the CORDIC's last x
//   shift_i      0..127, used one cycle after x_i
//   magnitude_o  s32, Q1.31: sat((x 2608131496) >>r (32 + shift)), valid one cycle after x_i
// The constant is round(K 2^32) = 8 * 326016437, and 326016437 = 2^28 + 57580981: 26 bits are left.
module vector_gain (
  input  logic               clk_i,
  input  logic               active_i,
  input  logic signed [38:0] x_i,
  input  logic        [ 6:0] shift_i,
  output logic        [31:0] magnitude_o,
  output logic               saturated_o
);

  // x < 2^38 in two digits; with fewer than 20 bits yosys would not take a 27x27 signed block.
  localparam logic signed [26:0] Gain = 27'sd57580981;
  logic signed [19:0] low_digit, high_digit;
  logic signed [46:0] low, high;
  assign low_digit = {1'b0, x_i[18:0]};
  assign high_digit = {1'b0, x_i[37:19]};
  assign low = low_digit * Gain;
  assign high = high_digit * Gain;
  // From bit 19 on: x 2^28 is x << 9 there.
  // The bit more at the bottom keeps yosys from making one sum of three terms out of LUTs.
  logic [46:0] upper;
  logic [47:0] product;
  assign upper = {1'b0, x_i[36:0], 9'b0} + high;
  assign product = {upper, 1'b1} + {20'b0, low[45:19], 1'b0};

  // (x 8 G) >>r (32 + s) = (x G) >>r (29 + s), of which bits 28 and up are enough.
  logic [37:0] product_q;
  always_ff @(posedge clk_i) begin
    if (active_i) product_q <= product[47:10];
  end

  logic [37:0] coarse, fine;
  logic unused_sign;
  always_comb begin
    case (shift_i[5:4])
      2'd0: coarse = product_q;
      2'd1: coarse = product_q >> 16;
      2'd2: coarse = product_q >> 32;
      default: coarse = '0;
    endcase
  end
  shift_multiplier u_shift (
    .data_i  ({1'b0, coarse}),
    .places_i(shift_i[3:0]),
    .data_o  ({unused_sign, fine})
  );

  logic [37:0] rounded;
  assign rounded = {1'b0, fine[37:1]} + 38'(fine[0]);
  assign saturated_o = !shift_i[6] && |rounded[37:31];
  assign magnitude_o = {1'b0, shift_i[6] ? '0 : rounded[30:0] | {31{saturated_o}}};

  logic unused_bits;
  assign unused_bits = (^product[9:0]) ^ low[46] ^ (^low[18:0]) ^ x_i[38];

endmodule
