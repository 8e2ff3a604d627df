// SPDX-License-Identifier: Apache-2.0
// The adders of multiplier_34x34.sv at full width. The partial products are cut (scripts/tool formal):
// any numbers in the ranges that products of such digits have. What is left to trust is that `*` of two
// 18-bit words is their product.
module multiplier_34x34_properties (
  input logic               clk_i,
  input logic signed [33:0] a_i, b_i
);

  logic signed [67:0] product;
  multiplier_34x34 dut (.a_i, .b_i, .product_o (product));

  (* hierconn *) logic signed [17:0] \dut.a0 ;
  (* hierconn *) logic signed [17:0] \dut.a1 ;
  (* hierconn *) logic signed [17:0] \dut.b0 ;
  (* hierconn *) logic signed [17:0] \dut.b1 ;
  (* hierconn *) logic signed [35:0] \dut.a0b0 ;
  (* hierconn *) logic signed [35:0] \dut.a1b0 ;
  (* hierconn *) logic signed [35:0] \dut.a0b1 ;
  (* hierconn *) logic signed [35:0] \dut.a1b1 ;

  localparam logic signed [35:0] Unsigned = (36'sd131071) * (36'sd131071);  // u17 * u17
  localparam logic signed [35:0] Mixed    = 36'sd65536 * 36'sd131071;       // s17 * u17
  localparam logic signed [35:0] Signed   = 36'sd65536 * 36'sd65536;        // s17 * s17

  logic signed [67:0] lower, middle, upper;
  assign lower  = \dut.a0b0 ;
  assign middle = \dut.a1b0 + 68'sd0 + \dut.a0b1 ;
  assign upper  = \dut.a1b1 ;

  logic signed [35:0] a_digits, b_digits;
  assign a_digits = $signed(\dut.a1 <<< 0);
  assign b_digits = $signed(\dut.b1 <<< 0);

  always @* begin
    assume (\dut.a0b0 >= 0 & \dut.a0b0 <= Unsigned);
    assume (\dut.a1b0 >= -Mixed & \dut.a1b0 <= Mixed);
    assume (\dut.a0b1 >= -Mixed & \dut.a0b1 <= Mixed);
    assume (\dut.a1b1 >= -Signed & \dut.a1b1 <= Signed);
    assert (product == lower + (middle <<< 17) + (upper <<< 34));
    assert (a_i == (a_digits <<< 17) + \dut.a0 & \dut.a0 >= 0);
    assert (b_i == (b_digits <<< 17) + \dut.b0 & \dut.b0 >= 0);
  end

endmodule
