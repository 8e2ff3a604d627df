// SPDX-License-Identifier: Apache-2.0
// slew_limit.sv: the error clamped to [-4^-n, 4^-n - 2^-31], for every error and every n.
module slew_limit_properties (
  input logic               clk_i,
  input logic        [ 2:0] slew_i,
  input logic signed [31:0] error_i
);

  logic signed [31:0] limited;
  slew_limit dut (.slew_i, .error_i, .error_o (limited));

  localparam logic signed [32:0] Range = 33'sd1 <<< 31;
  logic signed [32:0] most, due;
  assign most = Range >>> {slew_i, 1'b0};
  assign due  = error_i >= most ? most - 33'sd1 : error_i < -most ? -most : 33'(error_i);

  always @* assert (limited == due);

endmodule
