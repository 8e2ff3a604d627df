// SPDX-License-Identifier: Apache-2.0
// Exact product of a 48-bit and a 32-bit signed word, combinational: s48 * s32 = s80.
//
// Split by hand into digits of 17 bits, so that each partial product is one 18x18 signed block. A tool that splits a
// larger product may be wrong: yosys 0.23 and 0.55 lose its sign for this family.
module multiplier_48x32 (
  input  logic signed [47:0] a_i,
  input  logic signed [31:0] b_i,
  output logic signed [79:0] product_o
);

  logic signed [17:0] a0, a1, a2, b0, b1;
  assign a0 = {1'b0, a_i[16:0]};
  assign a1 = {1'b0, a_i[33:17]};
  assign a2 = 18'($signed(a_i[47:34]));
  assign b0 = {1'b0, b_i[16:0]};
  assign b1 = 18'($signed(b_i[31:17]));

  logic signed [35:0] a0b0, a1b0, a2b0, a0b1, a1b1, a2b1;
  assign a0b0 = a0 * b0;
  assign a1b0 = a1 * b0;
  assign a2b0 = a2 * b0;
  assign a0b1 = a0 * b1;
  assign a1b1 = a1 * b1;
  assign a2b1 = a2 * b1;

  // Where the lower one of two products is not negative they stand side by side without an adder:
  // a2b0:a0b0 from bit 0 on, a2b1:a1b0 from bit 17 on.
  logic signed [45:0] upper;     // a1b1 + a0b1, from bit 34 on
  logic signed [62:0] middle;    // from bit 17 on
  logic signed [63:0] sum;       // from bit 16 on
  assign upper = 46'($signed(a1b1)) + 46'($signed(a0b1[35:17]));
  assign middle = $signed({a2b1[28:0], a1b0[33:0]}) + $signed({upper, a0b1[16:0]});
  // The bit more at the bottom keeps yosys from making one sum of three terms out of LUTs.
  assign sum = $signed({middle, 1'b1}) + 64'($signed({a2b0, a0b0[33:17], 1'b0}));
  assign product_o = {sum[63:1], a0b0[16:0]};

  logic [11:0] unused_bits;
  assign unused_bits = {a0b0[35:34], a1b0[35:34], a2b1[35:29], sum[0]};

endmodule
