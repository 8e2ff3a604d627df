// SPDX-License-Identifier: Apache-2.0
// Checks harmonic_correction.sv against docs/reference/coprocessor.md, "Harmonic correction", for any node and its
// neighbour.
// T1 subtracts floor(S / 2^16). S is the exact sum of T[j] and of the node that each bit of f chooses, times the bit's
// weight.
// It also says whether one of these nodes does not fit its parity bit.
// Not proven is that such a sum is T[j] (2^16 - f) + T[j + 1] f.
// Assumed: nodes are not written in T1's tick, and its angle is stable from cycle 11 on.
module harmonic_correction_properties (
  input logic        clk_i, start_i, correct_i, write_i, bad_parity_i,
  input logic [31:0] phi_i, relative_i,
  input logic [6:0]  node_i,
  input logic [19:0] value_i
);

  // Ticks one after another, or with a rest between them.
  logic running = 1'b0;
  logic [4:0] cycle = '0;
  logic boundary;
  assign boundary = running ? cycle == 5'd31 : start_i;
  always @(posedge clk_i) begin
    if (boundary) running <= start_i;
    cycle <= running ? cycle + 5'd1 : 5'd0;
  end

  logic [31:0] relative;
  logic bad_node;
  harmonic_correction dut (
    .clk_i, .boundary_i (boundary), .cycle_i (cycle), .start_i, .correct_i, .phi_i, .write_i, .node_i, .value_i,
    .bad_parity_i, .relative_i, .relative_o (relative), .bad_node_o (bad_node)
  );
  (* hierconn *) logic [6:0]  \dut.probe ;
  (* hierconn *) logic [6:0]  \dut.probe_right ;
  (* hierconn *) logic [20:0] \dut.probed ;
  (* hierconn *) logic [20:0] \dut.probed_right ;
  (* hierconn *) logic [20:0] \dut.word_q ;
  (* hierconn *) logic [20:0] \dut.sum_q ;
  (* hierconn *) logic        \dut.correct_q ;
  (* hierconn *) logic [22:0] \dut.phi_q ;

  // What the registers were as the tick began, and both nodes.
  logic correct = 1'b0;
  logic [31:0] phi, relative_before;
  logic known = 1'b0, known_right = 1'b0, begun = 1'b0;
  logic signed [19:0] left, right;
  logic left_unfit, right_unfit;  // it does not fit its parity bit
  always @(posedge clk_i) begin
    relative_before <= relative_i;
    if (boundary) begin
      begun <= 1'b1;
      correct <= correct_i & start_i;
      phi <= phi_i;
    end
    if (write_i & node_i == \dut.probe ) begin
      known <= 1'b1;
      left <= value_i;
      left_unfit <= bad_parity_i;
    end
    if (write_i & node_i == \dut.probe_right ) begin
      known_right <= 1'b1;
      right <= value_i;
      right_unfit <= bad_parity_i;
    end
  end

  // The page's rule, bit by bit.
  logic [22:0] position;
  logic [15:0] fraction;
  logic watched;
  logic [3:0] index;
  logic signed [36:0] sum, term;
  logic signed [36:0] wide_left, wide_right;
  assign position = relative_i[31:9] + phi[31:9];
  assign fraction = position[15:0];
  assign watched = running & correct & known & known_right & position[22:16] == \dut.probe ;
  assign index = cycle[3:0] - 4'd14;
  assign wide_left = {{17{left[19]}}, left};
  assign wide_right = {{17{right[19]}}, right};
  assign term = (fraction[index] ? wide_right : wide_left) <<< index;
  always @(posedge clk_i) begin
    if (cycle == 5'd13) sum <= wide_left;
    else if (cycle >= 5'd14 & cycle <= 5'd29) sum <= sum + term;
  end

  logic [3:0] halvings;
  logic signed [36:0] halved, whole;
  assign halvings = cycle == 5'd14 ? 4'd0 : cycle == 5'd31 ? 4'd15 : cycle[3:0] - 4'd15;
  assign halved = sum >>> halvings;
  assign whole = sum >>> 16;

  // The words with their parity bits, and whether one of those in the sum does not fit.
  logic [20:0] left_word, right_word;
  logic [15:0] looked_at;
  logic unfit;
  assign left_word = {^left ^ left_unfit, left};
  assign right_word = {^right ^ right_unfit, right};
  assign looked_at = cycle >= 5'd30 ? '1 : ~(16'hFFFF << index);
  assign unfit = left_unfit | (right_unfit & |(fraction & looked_at));

  // How much the sum can be: k terms of 20 bits, the first of weight 1.
  logic signed [36:0] most;
  assign most = 37'sd524288 <<< halvings;

  always @* begin
    assume (~(write_i & running & cycle >= 5'd11 & cycle <= 5'd30));
    if (running & cycle >= 5'd12) assume (relative_i == relative_before);
    assert (running | cycle == 5'd0);
    if (begun) assert (\dut.correct_q == correct & \dut.phi_q == phi[31:9]);
    if (running) assert (begun);
    if (known) assert (\dut.probed == left_word);
    if (known_right) assert (\dut.probed_right == right_word);
    if (watched) begin
      if (cycle == 5'd13) assert (\dut.sum_q == '0 & \dut.word_q == left_word & ~bad_node);
      if (cycle >= 5'd14 & cycle <= 5'd29) assert (\dut.word_q == (fraction[index] ? right_word : left_word));
      if (cycle >= 5'd14) begin
        assert (\dut.sum_q == halved[20:0]);
        assert (bad_node == unfit);
        assert (sum >= -(most <<< 1) & sum <= (most <<< 1));
      end
      if (cycle >= 5'd30) assert (relative == relative_i - {whole[23:0], 8'b0});
    end
    if (running & ~correct) assert (\dut.sum_q == '0 & ~bad_node & relative == relative_i);
    if (running & cycle <= 5'd12) assert (\dut.sum_q == '0 & ~bad_node);
  end

endmodule
