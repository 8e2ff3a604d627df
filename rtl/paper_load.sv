// SPDX-License-Identifier: Apache-2.0
// Products of LOAD, Eq (8), in the paper's arithmetic, combinational: L1 gives a_u and b_u, L2 gives
// a_v and b_v.
//
//   amplitude_i        s32, Q1.31, not negative: a1, in L2 a2
//   sine_i, cosine_i   s32, Q1.31, of phi, in L2 of phi + beta
//   *_weight_o         s48, Q2.46: a word of Q1.31 times 2^15
// a_u = a1 cos, b_u = a1 sin, a_v = -a2 sin, b_v = a2 cos: Q62 >>r 16, then >>r 15 and clamped. The
// sine is negated before the product.
module paper_load (
  input  logic               second_i,  // L2
  input  logic signed [31:0] amplitude_i,
  input  logic signed [31:0] sine_i,
  input  logic signed [31:0] cosine_i,
  output logic signed [47:0] sine_weight_o,    // the weight of the sine: a
  output logic signed [47:0] cosine_weight_o   // b
);

  logic signed [33:0] sine, cosine;
  assign sine = second_i ? -(34'(sine_i)) : 34'(sine_i);
  assign cosine = 34'(cosine_i);

  logic signed [67:0] a_product, b_product;
  paper_multiplier u_a_product (
    .a_i      (34'(amplitude_i)),
    .b_i      (second_i ? sine : cosine),
    .product_o(a_product)
  );
  paper_multiplier u_b_product (
    .a_i      (34'(amplitude_i)),
    .b_i      (second_i ? cosine : sine),
    .product_o(b_product)
  );

  // |product| <= 2^62, so Q2.46 fits 48 bits and Q1.31 overshoots by one unit at most.
  function automatic logic signed [47:0] stored(input logic signed [48:0] product);
    logic signed [33:0] word;
    logic signed [47:0] fine;
    fine = product[48:1] + $signed({47'b0, product[0]});
    word = 34'(fine >>> 15) + $signed({33'b0, fine[14]});
    if (word[33:31] == 3'b000 || word[33:31] == 3'b111) stored = {word[32:0], 15'b0};
    else stored = {word[33], word[33], {31{~word[33]}}, 15'b0};
  endfunction

  logic unused_bits;
  assign unused_bits = ^{a_product[67:64], a_product[14:0], b_product[67:64], b_product[14:0]};

  assign sine_weight_o = stored(a_product[63:15]);
  assign cosine_weight_o = stored(b_product[63:15]);

endmodule
