// SPDX-License-Identifier: Apache-2.0
// Exact product of two 34-bit signed words, combinational: s34 * s34 = s68.
//
// Split by hand into digits of 17 bits: see multiplier_48x32.sv.
module multiplier_34x34 (
  input  logic signed [33:0] a_i,
  input  logic signed [33:0] b_i,
  output logic signed [67:0] product_o
);

  logic signed [17:0] a0, a1, b0, b1;
  assign a0 = {1'b0, a_i[16:0]};
  assign a1 = 18'($signed(a_i[33:17]));
  assign b0 = {1'b0, b_i[16:0]};
  assign b1 = 18'($signed(b_i[33:17]));

  logic signed [35:0] a0b0, a1b0, a0b1, a1b1;
  assign a0b0 = a0 * b0;
  assign a1b0 = a1 * b0;
  assign a0b1 = a0 * b1;
  assign a1b1 = a1 * b1;

  logic signed [35:0] mixed;  // from bit 17 on: two s34
  logic signed [51:0] sum;    // from bit 16 on
  assign mixed = a1b0 + a0b1;
  // The bit more at the bottom keeps yosys from making one sum of three terms out of LUTs.
  assign sum = $signed({a1b1[33:0], a0b0[33:17], 1'b1}) + 52'($signed({mixed, 1'b0}));
  assign product_o = {sum[51:1], a0b0[16:0]};

  logic [4:0] unused_bits;
  assign unused_bits = {a0b0[35:34], a1b1[35:34], sum[0]};

endmodule
