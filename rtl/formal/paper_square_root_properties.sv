// SPDX-License-Identifier: Apache-2.0
// The steps of paper_square_root.sv by their definition, from any state: x = min((a^2 + b^2) >> 31,
// 2^31 - 1), y <- clamp((y^2 >> 31) - x + y). The square is cut (scripts/tool formal): any number that the
// square of a Q1.31 word can be.
module paper_square_root_properties (
  input logic               clk_i,
  input logic               run_i,
  input logic        [4:0]  cycle_i,
  input logic signed [31:0] a_i, b_i
);

  logic signed [31:0] amplitude;
  logic saturated;
  paper_square_root dut (
    .clk_i, .rst_ni (1'b1), .run_i, .cycle_i, .a_i, .b_i,
    .amplitude_o (amplitude), .saturated_o (saturated)
  );
  (* hierconn *) logic signed [67:0] \dut.square ;
  (* hierconn *) logic signed [31:0] \dut.operand ;
  (* hierconn *) logic [62:0]        \dut.a_square_q ;
  (* hierconn *) logic [30:0]        \dut.x_q ;
  (* hierconn *) logic signed [31:0] \dut.y_q ;

  localparam logic signed [67:0] Most    = 68'sd1 <<< 62;  // (-1)^2
  localparam logic signed [67:0] Highest = 68'sd2147483647;
  localparam logic signed [67:0] Lowest  = -68'sd2147483648;
  logic signed [67:0] sum, y, x, next, due, minus_y;
  assign sum = (\dut.square + $signed({5'd0, \dut.a_square_q })) >>> 31;
  assign y = \dut.y_q ;
  assign x = {37'd0, \dut.x_q };
  assign next = (\dut.square >>> 31) - x + y;
  assign due = next > Highest ? Highest : next < Lowest ? Lowest : next;
  assign minus_y = -y;

  logic after = 1'b0;
  logic signed [67:0] x_due, y_due;
  logic saturated_due;
  always @(posedge clk_i) begin
    after <= 1'b1;
    x_due <= x;
    y_due <= y;
    saturated_due <= saturated;
    if (run_i & cycle_i == 5'd1) begin
      x_due <= sum > Highest ? Highest : sum;
      y_due <= sum > Highest ? -Highest : -sum;
      saturated_due <= sum > Highest;
    end
    if (run_i & cycle_i > 5'd1 & cycle_i < 5'd31) y_due <= due;
  end

  always @* begin
    assume (\dut.square >= 0 & \dut.square <= Most & \dut.a_square_q <= Most);
    assert (\dut.operand == (cycle_i == 5'd0 ? a_i : cycle_i == 5'd1 ? b_i : \dut.y_q ));
    assert (amplitude == (minus_y > Highest ? Highest : minus_y));
    if (after) assert (x == x_due & y == y_due & saturated == saturated_due);
  end

endmodule
