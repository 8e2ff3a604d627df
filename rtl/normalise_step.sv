// SPDX-License-Identifier: Apache-2.0
// One step of a serial normalisation: may a pair of signed words go left by 16, 4 or 1 places without
// either losing its sign? Combinational; the upper 17 bits of both words.
//
//   by16_o, by8_o, by4_o, by1_o  the step is allowed (each implies the next)
// Steps of 16, 4 and 1 bring 49 bits into place in at most 8 cycles, steps of 8 and 1 bring 67 bits
// into place in at most 14. When no step is allowed, one of the words fills its width.
module normalise_step (
  input  logic [16:0] x_i,
  input  logic [16:0] y_i,
  output logic        by16_o,
  output logic        by8_o,
  output logic        by4_o,
  output logic        by1_o
);

  // A bit that differs from the sign stops the words.
  logic [15:0] differs;
  assign differs = (x_i[15:0] ^ {16{x_i[16]}}) | (y_i[15:0] ^ {16{y_i[16]}});
  assign by16_o = ~|differs;
  assign by8_o = ~|differs[15:8];
  assign by4_o = ~|differs[15:12];
  assign by1_o = !differs[15];

endmodule
