// SPDX-License-Identifier: Apache-2.0
// The adders of multiplier_48x32.sv at full width. The partial products are cut (scripts/tool formal):
// any numbers in the ranges that products of such digits have.
module multiplier_48x32_properties (
  input logic               clk_i,
  input logic signed [47:0] a_i,
  input logic signed [31:0] b_i
);

  logic signed [79:0] product;
  multiplier_48x32 dut (.a_i, .b_i, .product_o (product));

  (* hierconn *) logic signed [17:0] \dut.a0 ;
  (* hierconn *) logic signed [17:0] \dut.a1 ;
  (* hierconn *) logic signed [17:0] \dut.a2 ;
  (* hierconn *) logic signed [17:0] \dut.b0 ;
  (* hierconn *) logic signed [17:0] \dut.b1 ;
  (* hierconn *) logic signed [35:0] \dut.a0b0 ;
  (* hierconn *) logic signed [35:0] \dut.a1b0 ;
  (* hierconn *) logic signed [35:0] \dut.a2b0 ;
  (* hierconn *) logic signed [35:0] \dut.a0b1 ;
  (* hierconn *) logic signed [35:0] \dut.a1b1 ;
  (* hierconn *) logic signed [35:0] \dut.a2b1 ;

  localparam logic signed [35:0] Unsigned = 36'sd131071 * 36'sd131071;  // u17 * u17
  localparam logic signed [35:0] Mixed    = 36'sd16384 * 36'sd131071;   // u17 * s15
  localparam logic signed [35:0] Short    = 36'sd8192 * 36'sd131071;    // s14 * u17
  localparam logic signed [35:0] Signed   = 36'sd8192 * 36'sd16384;     // s14 * s15

  (* hierconn *) logic signed [62:0] \dut.middle ;

  // By association, so that each claim is one addition; products of equal weight stand together:
  //   product = (a2b0 2^34 + a0b0) + 2^17 middle,
  //   middle  = (a2b1 2^34 + a1b0) + (a1b1 2^17 + a0b1).
  logic signed [79:0] a0b0, a1b0, a2b0, a0b1, a1b1, a2b1, middle, a2, a1, a0, b1, b0;
  assign a0b0   = \dut.a0b0 ;
  assign a1b0   = \dut.a1b0 ;
  assign a2b0   = \dut.a2b0 ;
  assign a0b1   = \dut.a0b1 ;
  assign a1b1   = \dut.a1b1 ;
  assign a2b1   = \dut.a2b1 ;
  assign middle = \dut.middle ;
  assign a2 = \dut.a2 ;
  assign a1 = \dut.a1 ;
  assign a0 = \dut.a0 ;
  assign b1 = \dut.b1 ;
  assign b0 = \dut.b0 ;

  always @* begin
    assume (\dut.a0b0 >= 0 & \dut.a0b0 <= Unsigned);
    assume (\dut.a1b0 >= 0 & \dut.a1b0 <= Unsigned);
    assume (\dut.a2b0 >= -Short & \dut.a2b0 <= Short);
    assume (\dut.a0b1 >= -Mixed & \dut.a0b1 <= Mixed);
    assume (\dut.a1b1 >= -Mixed & \dut.a1b1 <= Mixed);
    assume (\dut.a2b1 >= -Signed & \dut.a2b1 <= Signed);
    assert (middle == ((a2b1 <<< 34) + a1b0) + ((a1b1 <<< 17) + a0b1));
    assert (product == ((a2b0 <<< 34) + a0b0) + (middle <<< 17));
    assert (a_i == (a2 <<< 34) + (a1 <<< 17) + a0 & a1 >= 0 & a0 >= 0);
    assert (b_i == (b1 <<< 17) + b0 & b0 >= 0);
  end

endmodule
