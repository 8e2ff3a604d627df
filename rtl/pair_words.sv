// SPDX-License-Identifier: Apache-2.0
// The words of a 48-bit register as software sees them (docs/reference/coprocessor.md, "Registers").
//
// Combinational. Coefficients, Q2.46: value = HI * 2^15 + LO with HI = clamp(value >>r 15) in Q1.31
// and LO = clamp(what is then missing) in 2^-46, both s32; >>r rounds half up. Phase and frequency,
// 2^-48 turn: HI is bits 47:16, LO bits 15:0.
// paper: coefficients are rounded and clamped to Q1.31 when they are written.
module pair_words #(
  parameter int Paper = 0
) (
  input  logic        coefficient_i,  // 0: phase or frequency
  // Reading
  input  logic [47:0] value_i,
  output logic [31:0] high_o,
  output logic [31:0] low_o,
  // Writing: the value of (high_i, low_i), exact
  input  logic [31:0] high_i,
  input  logic [31:0] low_i,
  output logic [47:0] coefficient_o,
  output logic [47:0] phase_o
);

  // HI leaves its range from 1 - 2^-32 upwards and below -1 - 2^-32.
  logic above, below, carry;
  assign above = ~value_i[47] & (value_i[46] | (&value_i[45:14]));
  assign below = value_i[47] & ~value_i[46] & ~(&value_i[45:14]);

  // One adder serves HI and the LO of a clamped HI: 2^31 - 1 - HI is -(2^31) + 1 + HI's other bits.
  assign carry = above | (value_i[14] & ~below);
  logic [32:0] sum;
  assign sum = value_i[47:15] + 33'(carry);

  logic        low_above, low_below;
  logic [31:0] coefficient_high, coefficient_low;
  assign low_above = above & (sum[32] | (|sum[30:16]));
  assign low_below = below & ~(&sum[30:16]);
  always_comb begin
    coefficient_high = sum[31:0];
    coefficient_low  = {{17{value_i[14]}}, value_i[14:0]};
    if (above | below) begin
      coefficient_high = {below, {31{above}}};
      coefficient_low  = {below, sum[15:0], value_i[14:0]};
    end
    if (low_above | low_below) coefficient_low = {below, {31{above}}};
  end

  assign high_o = coefficient_i ? coefficient_high : value_i[47:16];
  assign low_o  = coefficient_i ? coefficient_low : {16'd0, value_i[15:0]};

  if (Paper != 0) begin : gen_paper
    logic [32:0] rounded;
    assign rounded = {high_i[31], high_i} + {{16{low_i[31]}}, low_i[31:15]} + 33'(low_i[14]);
    // Clamped where the two sign bits differ.
    logic [30:0] fraction;
    assign fraction = rounded[32] == rounded[31] ? rounded[30:0] : {31{~rounded[32]}};
    assign coefficient_o = {{2{rounded[32]}}, fraction, 15'd0};
  end else begin : gen_precise
    assign coefficient_o = {{high_i[31], high_i} + {{16{low_i[31]}}, low_i[31:15]}, low_i[14:0]};
  end
  assign phase_o = {high_i, low_i[15:0]};

endmodule
