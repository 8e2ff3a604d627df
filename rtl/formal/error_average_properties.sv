// The error average's arithmetic by its definition (error_average.sv), for every sum and error.
module error_average_properties (
  input logic               clk_i, clear_i, boundary_i, commit_i, error_valid_i,
  input logic signed [31:0] error_i,
  input logic        [31:0] lock_threshold_i, diverge_threshold_i
);

  logic in_reset = 1'b1;
  always @(posedge clk_i) in_reset <= 1'b0;

  logic [31:0] average;
  logic        lock, diverged;
  error_average dut (
    .clk_i, .rst_ni (~in_reset), .clear_i, .boundary_i, .commit_i, .error_valid_i, .error_i,
    .lock_threshold_i, .diverge_threshold_i,
    .average_o (average), .lock_o (lock), .diverged_o (diverged)
  );

  (* hierconn *) logic [37:0] \dut.sum_q ;
  (* hierconn *) logic [37:0] \dut.other_q ;
  (* hierconn *) logic [37:0] \dut.next ;

  logic [63:0] sum, size, other, larger;
  assign sum    = \dut.sum_q ;
  assign other  = \dut.other_q ;
  assign size   = error_i < 0 ? -{{32{error_i[31]}}, error_i} : {32'd0, error_i};
  assign larger = sum < other ? other : sum;

  // 64 times the largest average is 2^37: the sums stay at or below it.
  localparam logic [63:0] Most = 64'd1 << 37;
  logic [63:0] due;
  assign due = sum + size - ((sum + 64'd32) >> 6);

  always @* begin
    if (sum <= Most & other <= Most) begin
      assert (due <= Most & \dut.next == due[37:0]);
      assert (average == (larger + 64'd32) >> 6);
    end
  end

endmodule
