// SPDX-License-Identifier: Apache-2.0
// Limited slew of the weights: the error that an update sees, clamped to s(32 - 2 n), n = JUDGE.SLEW.
//
//   slew_i   n; 0: no limit
//   error_i  s32, Q1.31
//   error_o  the same within [-4^-n, 4^-n - 2^-31]
//
// Combinational. A pair of bits that the limit takes away must be as the sign is; if one is not, all bits
// that it leaves become the sign's inverse.
module slew_limit (
  input  logic        [ 2:0] slew_i,
  input  logic signed [31:0] error_i,
  output logic signed [31:0] error_o
);

  logic sign;
  logic [6:0] taken, differs;  // pair j: bits 30 - 2 j, 29 - 2 j
  logic over;
  assign sign = error_i[31];
  for (genvar j = 0; j < 7; j = j + 1) begin : g_pair
    assign taken[j] = slew_i > 3'(j);
    assign differs[j] = error_i[30-2*j] != sign || error_i[29-2*j] != sign;
    assign error_o[30-2*j] = taken[j] ? sign : over ? !sign : error_i[30-2*j];
    assign error_o[29-2*j] = taken[j] ? sign : over ? !sign : error_i[29-2*j];
  end
  assign over = |(taken & differs);
  assign error_o[31] = sign;
  assign error_o[16:0] = over ? {17{!sign}} : error_i[16:0];

endmodule
