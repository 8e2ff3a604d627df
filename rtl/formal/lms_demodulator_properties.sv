// SPDX-License-Identifier: Apache-2.0
// What lms_demodulator.sv makes of its sums and products, from any state: the saturated error, what of
// it is kept for the update, and the rounded, saturated new weight. The products are cut (scripts/tool formal): any number in their range.
module lms_demodulator_properties (
  input logic               clk_i,
  input logic               boundary_i, active_i,
  input logic        [4:0]  cycle_i,
  input logic               load_u_i, load_v_i,
  input logic signed [47:0] weight_i,
  input logic signed [33:0] weight_q31_i, difference_i,
  input logic signed [31:0] sine_i, cosine_i,
  input logic        [2:0]  slew_i
);

  logic error_valid, error_saturated, weight_valid, weight_saturated;
  logic signed [31:0] error;
  logic signed [47:0] weight;
  lms_demodulator dut (
    .clk_i, .rst_ni (1'b1), .boundary_i, .active_i, .cycle_i, .load_u_i, .load_v_i,
    .load_u_start_i (1'b0), .load_v_start_i (1'b0), .a1_i ('0), .a2_i ('0),
    .steps_i ('0), .slew_i,
    .weight_i, .weight_q31_i, .difference_i, .sine_i, .cosine_i,
    .error_valid_o (error_valid), .error_o (error), .error_saturated_o (error_saturated),
    .weight_valid_o (weight_valid), .weight_o (weight), .weight_saturated_o (weight_saturated)
  );
  (* hierconn *) logic signed [65:0] \dut.sum_q ;
  (* hierconn *) logic signed [79:0] \dut.product ;
  (* hierconn *) logic signed [31:0] \dut.error_u_q ;
  (* hierconn *) logic signed [31:0] \dut.error_v_q ;

  // err = sat(sum >> 31)
  localparam logic signed [81:0] HighestError = 82'sd2147483647;
  localparam logic signed [81:0] LowestError  = -82'sd2147483648;
  logic signed [81:0] sum;
  assign sum = \dut.sum_q ;
  logic signed [81:0] error_due;
  assign error_due = sum >>> 31;

  // The update sees the error within 4^-n, n as it was at the tick's start.
  logic [2:0] slew;
  logic known = 1'b0;
  always @(posedge clk_i) if (boundary_i) begin
    slew  <= slew_i;
    known <= 1'b1;
  end
  logic signed [81:0] most_kept, kept_due;
  assign most_kept = 82'sd1 <<< (31 - {28'd0, slew, 1'b0});
  assign kept_due = error >= most_kept ? most_kept - 82'sd1 : error < -most_kept ? -most_kept : 82'(error);
  logic captured_u = 1'b0, captured_v = 1'b0;
  logic signed [31:0] kept;
  always @(posedge clk_i) begin
    captured_u <= known & active_i & cycle_i == 5'd4;
    captured_v <= known & active_i & cycle_i == 5'd8;
    kept <= kept_due[31:0];
  end
  always @* begin
    if (captured_u) assert (\dut.error_u_q == kept);
    if (captured_v) assert (\dut.error_v_q == kept);
  end

  // W' = sat(W + p >>r 31), with g_2 and the products of LOAD p >>r 16; LOAD's sine of v is negated.
  localparam logic signed [81:0] HighestWeight = (82'sd1 <<< 47) - 82'sd1;
  localparam logic signed [81:0] LowestWeight  = -(82'sd1 <<< 47);
  logic load, constant, negative;
  assign load = load_u_i | load_v_i;
  assign constant = cycle_i == 5'd19 | cycle_i == 5'd25;
  assign negative = load_v_i & (cycle_i == 5'd16 | cycle_i == 5'd22);
  logic signed [81:0] product, term, weight_due;
  assign product = negative ? -\dut.product : \dut.product ;
  assign term = load | constant ? (product + 82'sd32768) >>> 16 : (product + 82'sd1073741824) >>> 31;
  assign weight_due = weight_i + term;

  // |err step| < 2^62, so |g r| < 2^78; LOAD and g_2 have the former kind. Estimates fill 66 bits.
  localparam logic signed [81:0] MostUpdate = 82'sd1 <<< 77;
  localparam logic signed [81:0] MostGain   = 82'sd1 <<< 62;
  logic signed [81:0] most;
  assign most = load | constant ? MostGain : MostUpdate;

  always @* begin
    assume (\dut.product <= most & \dut.product >= -most);
    assert (error == (error_due > HighestError ? HighestError :
                      error_due < LowestError ? LowestError : error_due));
    assert (error_saturated == (error_valid & (error_due > HighestError | error_due < LowestError)));
    if (cycle_i == 5'd16 | cycle_i == 5'd18 | cycle_i == 5'd19 |
        cycle_i == 5'd22 | cycle_i == 5'd24 | cycle_i == 5'd25) begin
      assert (weight == (weight_due > HighestWeight ? HighestWeight :
                         weight_due < LowestWeight ? LowestWeight : weight_due));
      assert (weight_saturated == (weight_valid &
                                   (weight_due > HighestWeight | weight_due < LowestWeight)));
    end
  end

endmodule
