// SPDX-License-Identifier: Apache-2.0
// In place of the units inside of polar_unit.sv, which have their own proofs: any outputs, and inputs that the proof of
// the polar unit looks at.
module polar_normaliser (
  input  logic        clk_i,
  input  logic        active_i,
  input  logic [ 4:0] cycle_i,
  input  logic [47:0] weight3_i,
  input  logic [47:0] weight4_i,
  input  logic [47:0] weight5_i,
  output logic [36:0] x_o,
  output logic [36:0] y_o,
  output logic [ 6:0] shift_o,
  output logic        zero_o
);
endmodule

module vectoring_step #(
  parameter int Offset = 0
) (
  input  logic        [ 1:0] thirds_i,
  input  logic        [ 1:0] rest_i,
  input  logic signed [38:0] x_i,
  input  logic signed [38:0] y_i,
  input  logic        [36:0] z_i,
  output logic signed [38:0] x_o,
  output logic signed [38:0] y_o,
  output logic        [36:0] z_o
);
  logic [1:0] offset;
  assign offset = Offset;
endmodule

module vector_gain (
  input  logic               clk_i,
  input  logic               active_i,
  input  logic signed [38:0] x_i,
  input  logic        [ 6:0] shift_i,
  output logic        [31:0] magnitude_o,
  output logic               saturated_o
);
endmodule
