// SPDX-License-Identifier: Apache-2.0
// Multiplier of the paper's units: exact product of two signed words, combinational.
//
// Format: a_i, b_i s34; product_o s68, as many fraction bits as both have together. No rounding.
//
// Written as four 18 x 18 products of 17-bit halves: one DSP block of a Cyclone V holds two of them,
// and synthesis is not left to split a wider product.
module paper_multiplier (
  input  logic signed [33:0] a_i,
  input  logic signed [33:0] b_i,
  output logic signed [67:0] product_o
);

  logic signed [17:0] a_low, a_high, b_low, b_high;
  assign a_low = {1'b0, a_i[16:0]};
  assign a_high = {a_i[33], a_i[33:17]};
  assign b_low = {1'b0, b_i[16:0]};
  assign b_high = {b_i[33], b_i[33:17]};

  logic signed [35:0] low_low, low_high, high_low, high_high;
  assign low_low = a_low * b_low;
  assign low_high = a_low * b_high;
  assign high_low = a_high * b_low;
  assign high_high = a_high * b_high;

  // The outer products do not overlap: low_low is never negative and below 2^34.
  logic signed [67:0] outer, middle;
  assign outer = {high_high[33:0], low_low[33:0]};
  assign middle = 68'(low_high) + 68'(high_low);
  assign product_o = outer + (middle <<< 17);

  logic unused_bits;
  assign unused_bits = ^{high_high[35:34], low_low[35:34]};

endmodule
