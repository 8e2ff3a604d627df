// SPDX-License-Identifier: Apache-2.0
// Arithmetic shift right by 0 to 15 places, combinational: data_o = data_i >> places_i, s39, floor.
//
// Three multipliers by a power of two stand in for two levels of multiplexers: the coprocessor has
// DSP blocks to spare and no ALMs. The word is cut into digits of 14, 15 and 10 bits; multiplied by
// 2^(15 - places) no more than two of them meet at any bit, and one of the two is 0 there.
module shift_multiplier (
  input  logic signed [38:0] data_i,
  input  logic        [ 3:0] places_i,
  output logic signed [38:0] data_o
);

  logic signed [16:0] scale;
  assign scale = 17'd1 << ~places_i;

  logic signed [14:0] digit0;
  logic signed [15:0] digit1;
  logic signed [ 9:0] digit2;
  assign digit0 = {1'b0, data_i[13:0]};
  assign digit1 = {1'b0, data_i[28:14]};
  assign digit2 = data_i[38:29];

  logic signed [31:0] part0, part1;
  logic signed [26:0] part2;
  assign part0 = digit0 * scale;
  assign part1 = digit1 * scale;
  assign part2 = digit2 * scale;

  // part0 stands at bit 0, part1 at bit 14, part2 at bit 29; the result begins at bit 15.
  assign data_o = $signed({part2[24:15], part2[14:0] | part1[29:15], part1[14:1] | part0[28:15]});

  logic unused_bits;
  assign unused_bits = ^{part0[31:29], part0[14:0], part1[31:30], part1[0], part2[26:25]};

endmodule
