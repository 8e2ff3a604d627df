// SPDX-License-Identifier: Apache-2.0
// Follows one vector through polar_normaliser.sv, from its load in cycle 0 or 10 to the cycle in which it is taken. No
// bit is lost, the shift counts the places, and the larger word is left-aligned.
module polar_normaliser_properties (
  input logic        clk_i,
  input logic [47:0] weight3_i, weight4_i, weight5_i
);

  logic [36:0] x, y;
  logic [6:0]  shift;
  logic        zero;
  logic [4:0]  cycle;
  polar_normaliser dut (
    .clk_i, .active_i (1'b1), .cycle_i (cycle), .weight3_i, .weight4_i, .weight5_i,
    .x_o (x), .y_o (y), .shift_o (shift), .zero_o (zero)
  );
  (* hierconn *) logic [48:0] \dut.x_q ;
  (* hierconn *) logic [48:0] \dut.y_q ;

  // Which of the two vectors; step 0 loads it.
  (* anyconst *) logic second;
  logic [3:0] step = 4'd0;
  always @(posedge clk_i) if (step != 4'd9) step <= step + 4'd1;
  assign cycle = {1'b0, step} + (second ? 5'd10 : 5'd0);

  logic started = 1'b0;
  logic signed [48:0] x_now, y_now, x_due, y_due;
  logic signed [48:0] x_before, y_before;
  logic [6:0] shift_before, places;
  assign x_now = \dut.x_q ;
  assign y_now = \dut.y_q ;
  assign places = shift - shift_before;
  always @(posedge clk_i) begin
    started <= 1'b1;
    x_before <= x_now;
    y_before <= y_now;
    shift_before <= shift;
    x_due <= {weight4_i[47], weight4_i};
    y_due <= second ? {weight5_i[47], weight5_i} : -{weight3_i[47], weight3_i};
  end

  always @* begin
    if (started & step == 4'd1) assert (x_now == x_due & y_now == y_due & shift == 7'd2);
    // From cycle to cycle: by the places that the shift grew, which can be taken back.
    if (started & step > 4'd1) begin
      assert (places == 7'd0 | places == 7'd1 | places == 7'd4 | places == 7'd16);
      if (places == 7'd0) assert (x_now == x_before & y_now == y_before);
      if (places == 7'd1) assert (x_now >>> 1 == x_before & y_now >>> 1 == y_before & ~x_now[0] & ~y_now[0]);
      if (places == 7'd4) begin
        assert (x_now >>> 4 == x_before & y_now >>> 4 == y_before & ~|x_now[3:0] & ~|y_now[3:0]);
      end
      if (places == 7'd16) begin
        assert (x_now >>> 16 == x_before & y_now >>> 16 == y_before);
        assert (~|x_now[15:0] & ~|y_now[15:0]);
      end
    end
    // In the cycle in which it is taken.
    if (step == 4'd9) begin
      assert (zero == (x_now == 0 & y_now == 0));
      assert (zero | x_now[48] != x_now[47] | y_now[48] != y_now[47]);
      assert (x == x_now[48:12] & y == y_now[48:12]);
    end
  end

endmodule
