// SPDX-License-Identifier: Apache-2.0
// The adders of paper_multiplier.sv at full width. The partial products are cut (scripts/tool formal):
// any numbers in the ranges that products of such digits have. What is left to trust is that `*` of two
// 18-bit words is their product.
module paper_multiplier_properties (
  input logic               clk_i,
  input logic signed [33:0] a_i, b_i
);

  logic signed [67:0] product;
  paper_multiplier dut (.a_i, .b_i, .product_o (product));

  (* hierconn *) logic signed [17:0] \dut.a_low ;
  (* hierconn *) logic signed [17:0] \dut.a_high ;
  (* hierconn *) logic signed [17:0] \dut.b_low ;
  (* hierconn *) logic signed [17:0] \dut.b_high ;
  (* hierconn *) logic signed [35:0] \dut.low_low ;
  (* hierconn *) logic signed [35:0] \dut.high_low ;
  (* hierconn *) logic signed [35:0] \dut.low_high ;
  (* hierconn *) logic signed [35:0] \dut.high_high ;

  localparam logic signed [35:0] Unsigned = (36'sd131071) * (36'sd131071);  // u17 * u17
  localparam logic signed [35:0] Mixed    = 36'sd65536 * 36'sd131071;       // s17 * u17
  localparam logic signed [35:0] Signed   = 36'sd65536 * 36'sd65536;        // s17 * s17

  logic signed [67:0] lower, middle, upper;
  assign lower  = \dut.low_low ;
  assign middle = \dut.high_low + 68'sd0 + \dut.low_high ;
  assign upper  = \dut.high_high ;

  logic signed [35:0] a_digits, b_digits;
  assign a_digits = $signed(\dut.a_high <<< 0);
  assign b_digits = $signed(\dut.b_high <<< 0);

  always @* begin
    assume (\dut.low_low >= 0 & \dut.low_low <= Unsigned);
    assume (\dut.high_low >= -Mixed & \dut.high_low <= Mixed);
    assume (\dut.low_high >= -Mixed & \dut.low_high <= Mixed);
    assume (\dut.high_high >= -Signed & \dut.high_high <= Signed);
    assert (product == lower + (middle <<< 17) + (upper <<< 34));
    assert (a_i == (a_digits <<< 17) + \dut.a_low & \dut.a_low >= 0);
    assert (b_i == (b_digits <<< 17) + \dut.b_low & \dut.b_low >= 0);
  end

endmodule
