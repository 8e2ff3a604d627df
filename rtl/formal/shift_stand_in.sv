// SPDX-License-Identifier: Apache-2.0
// In place of shift_multiplier.sv's products, whose proof is shift_multiplier_properties.sv: for the proofs of who uses it.
module shift_multiplier (
  input  logic signed [38:0] data_i,
  input  logic        [3:0]  places_i,
  output logic signed [38:0] data_o
);
  assign data_o = data_i >>> places_i;
endmodule
