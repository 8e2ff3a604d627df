// SPDX-License-Identifier: Apache-2.0
// a + b or a - b with a carry, combinational: a + (b ^ {W{minus}}) + carry, modulo 2^Width.
//
// Bits have any weight; minus_i = carry_i gives a - b or a + b, and a separate carry takes the
// rounding bit r of a shifted b: -(b + r) = ~b + ~r.
// A separate module because the adder of an ALM inverts one operand at no cost, which yosys does
// not find by itself: scripts/tool synth maps this module onto the cell that can. One adder is written
// with an extra bit at the bottom, so that no tool makes two of it.
module add_subtract #(
  parameter int Width = 32
) (
  input  logic [Width-1:0] a_i,
  input  logic [Width-1:0] b_i,
  input  logic             minus_i,
  input  logic             carry_i,
  output logic [Width-1:0] sum_o
);

  logic unused_sum;
  assign {sum_o, unused_sum} = {a_i, 1'b1} + {b_i ^ {Width{minus_i}}, carry_i};

endmodule
