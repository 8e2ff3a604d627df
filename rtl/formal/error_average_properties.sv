// SPDX-License-Identifier: Apache-2.0
// Checks the error average against its definition (error_average.sv), for every sum and error.
// Covers its arithmetic, the sums of both channels in turn, a reset, and LOCK and DIVERGED from the 63rd sample on.
module error_average_properties (
  input logic               clk_i, rst_ni, clear_i, boundary_i, commit_i, error_valid_i,
  input logic signed [31:0] error_i,
  input logic        [31:0] lock_threshold_i, diverge_threshold_i
);

  logic known = 1'b0;  // before it the registers are anything
  always @(posedge clk_i) known <= 1'b1;

  logic [31:0] average;
  logic        lock, diverged;
  error_average dut (
    .clk_i, .rst_ni, .clear_i, .boundary_i, .commit_i, .error_valid_i, .error_i,
    .lock_threshold_i, .diverge_threshold_i,
    .average_o (average), .lock_o (lock), .diverged_o (diverged)
  );

  (* hierconn *) logic [37:0] \dut.sum_q ;
  (* hierconn *) logic [37:0] \dut.other_q ;
  (* hierconn *) logic [37:0] \dut.next ;
  (* hierconn *) logic        \dut.empty_q ;
  (* hierconn *) logic [ 5:0] \dut.settled_q ;

  logic [63:0] sum, size, other, larger;
  assign sum    = \dut.sum_q ;
  assign other  = \dut.other_q ;
  assign size   = error_i < 0 ? -{{32{error_i[31]}}, error_i} : {32'd0, error_i};
  assign larger = sum < other ? other : sum;

  // 64 times the largest average is 2^37: the sums stay at or below it.
  localparam logic [63:0] Most = 64'd1 << 37;
  logic [63:0] due;
  assign due = sum + size - ((sum + 64'd32) >> 6);

  // Values after this cycle. The sums from before a reset are gone with the first boundary after it, before an error
  // comes.
  logic [37:0] sum_due, other_due;
  logic        empty_due, begins;
  logic [ 5:0] settled_due;
  assign begins = boundary_i && \dut.empty_q ;
  always @(posedge clk_i) begin
    sum_due     <= begins ? 38'd0 : error_valid_i ? \dut.other_q : \dut.sum_q ;
    other_due   <= begins ? 38'd0 : error_valid_i ? \dut.next : \dut.other_q ;
    empty_due   <= clear_i || !rst_ni || (\dut.empty_q && !error_valid_i);
    settled_due <= clear_i || !rst_ni ? 6'd0 : \dut.settled_q == 6'd63 ? 6'd63 : \dut.settled_q + 6'(commit_i);
  end
  logic settled;
  assign settled = \dut.settled_q == 6'd63 || (\dut.settled_q == 6'd62 && commit_i);

  always @* begin
    if (known) assert (\dut.sum_q == sum_due && \dut.other_q == other_due);
    if (!rst_ni) assert (\dut.empty_q && \dut.settled_q == 6'd0);
    else if (known) assert (\dut.empty_q == empty_due && \dut.settled_q == settled_due);
    assert (lock == (settled && average < lock_threshold_i));
    assert (diverged == (settled && average > diverge_threshold_i));
    if (sum <= Most & other <= Most) begin
      assert (due <= Most & \dut.next == due[37:0]);
      assert (average == (larger + 64'd32) >> 6);
    end
  end

endmodule
