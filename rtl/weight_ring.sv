// SPDX-License-Identifier: Apache-2.0
// The tick's copy of the six weights, as a ring. A unit that needs a weight waits until the weight passes a tap. That
// costs one multiplexer instead of one for each reader.
//
// Formats: weights s48, Q2.46; offsets s32, Q1.31.
// At home (cycles 0 and 26 to 31) place 0..5 holds a_u, b_u, c_u, a_v, b_v, c_v. The ring turns by
// one place (place i takes place i + 1) at the end of cycles
//   0 1 3 4 5 7       the estimate: place 0 is a_u, b_u, c_u (2 and 3), a_v, b_v, c_v (6 and 7)
//   8 .. 13           the calibrator's products
//   16 18 19 22 24 25 the update: the word that leaves place 0 may be replaced by word_i
// In a block the update is of the block's sums: from cycle 13 on they come into place 0, for the weights are not needed any more
// in this tick.
// A LOAD begins with the offset, << 15, in place of the constant that it makes, and makes the other two zero in the first turns.
//
// Each place has a parity bit. A word that replaces one without the right bit gets the wrong bit, too, so that all that changed on
// its way during the tick is seen at the tick's end: bad_o. With Safety = 0 it is 0.
module weight_ring #(
  parameter int Safety = 1
) (
  input  logic        clk_i,
  input  logic        boundary_i,
  input  logic        active_i,       // a tick runs
  input  logic [4:0]  cycle_i,
  input  logic        keep_u_i,       // with boundary_i: u's weights are this tick's results
  input  logic        keep_v_i,
  input  logic        load_u_i,       // with boundary_i: L1 begins
  input  logic        load_v_i,       // with boundary_i: L2 begins
  input  logic        from_sums_i,    // T3 is in a block
  input  logic [47:0] sum_i,          // of the weight that comes to place 0
  input  logic [31:0] b1_i,
  input  logic [31:0] b2_i,
  input  weights_t    weights_i,
  input  logic        replace_i,
  input  logic [47:0] word_i,
  input  logic        bad_parity_i,   // words that replace one get the wrong bit
  output logic        bad_o,          // with boundary_i
  output logic        turn_o,
  output weights_t    weights_o      // the places, each under the name of the weight that is at home there
);

  logic [47:0] place0_q, place1_q, place2_q, place3_q, place4_q, place5_q;

  //                                      cycle 31 ...                 ... cycle 0
  localparam logic [31:0] TurnInCycle = 32'b0000_0011_0100_1101_0011_1111_1011_1011;
  logic turn;
  assign turn = active_i && TurnInCycle[cycle_i];
  assign turn_o = turn;

  // A LOAD's weights that are not there yet become zero on their way from place 5 to 4, in the turns of cycles 1 and 3, 5 and 7.
  logic zero;
  assign zero = cycle_i[0] && ((load_u_q && cycle_i[4:2] == 3'd0) || (load_v_q && cycle_i[4:2] == 3'd1));

  // The sums come into place 0 with the turns at the end of cycles 13 to 24.
  logic take_sum;
  assign take_sum = from_sums_i && cycle_i >= 5'd13 && cycle_i != 5'd25;

  // What a tick begins with.
  logic [47:0] start2, start5;
  assign start2 = load_u_i ? {b1_i[31], b1_i, 15'b0} : weights_i.cu;
  assign start5 = load_v_i ? {b2_i[31], b2_i, 15'b0} : weights_i.cv;

  // No reset: every tick begins with a load.
  logic load_u_q, load_v_q;
  always_ff @(posedge clk_i) begin
    if (boundary_i) begin
      load_u_q <= load_u_i;
      load_v_q <= load_v_i;
      if (!keep_u_i) begin
        place0_q <= weights_i.au;
        place1_q <= weights_i.bu;
        place2_q <= start2;
      end
      if (!keep_v_i) begin
        place3_q <= weights_i.av;
        place4_q <= weights_i.bv;
        place5_q <= start5;
      end
    end else if (turn) begin
      place0_q <= take_sum ? sum_i : place1_q;
      place1_q <= place2_q;
      place2_q <= place3_q;
      place3_q <= place4_q;
      place4_q <= place5_q & {48{!zero}};
      place5_q <= replace_i ? word_i : place0_q;
    end
  end

  // Bit i is of place i. The bit of a word that came into place 5 with the last turn is made in the cycle after.
  logic [5:0] parity_q, parity, odd;
  logic came_q, came_bad_q;
  assign parity = {came_q ? ^place5_q ^ came_bad_q : parity_q[5], parity_q[4:0]};
  always_ff @(posedge clk_i) begin
    if (active_i || boundary_i) came_q <= turn && replace_i;
    if (turn) came_bad_q <= bad_parity_i || (^place0_q ^ parity_q[0]);
    if (boundary_i) begin
      if (!keep_u_i) parity_q[2:0] <= {^start2, ^weights_i.bu, ^weights_i.au};
      if (!keep_v_i) parity_q[5:3] <= {^start5, ^weights_i.bv, ^weights_i.av};
    end else if (turn) begin
      parity_q <= {parity_q[0], parity[5] && !zero, parity_q[4:2], take_sum ? ^sum_i : parity_q[1]};
    end else if (active_i) begin
      parity_q[5] <= parity[5];
    end
  end
  assign odd = {^place5_q, ^place4_q, ^place3_q, ^place2_q, ^place1_q, ^place0_q};
  assign bad_o = boundary_i && Safety != 0 && odd != parity;

  assign weights_o.au = place0_q;
  assign weights_o.bu = place1_q;
  assign weights_o.cu = place2_q;
  assign weights_o.av = place3_q;
  assign weights_o.bv = place4_q;
  assign weights_o.cv = place5_q;

endmodule
