// SPDX-License-Identifier: Apache-2.0
// Checks block_learning.sv against docs/reference/coprocessor.md, "Block learning". Covers the three cases of T3's
// start, and any one of the six sums, from the cycle in which T3 writes it to the one in which the ring takes it. If it does not
// fit its parity bit then, the tick says so; that nothing else makes it say so is not proven.
module block_learning_properties (
  input logic        clk_i, clear_i, boundary_i, active_i,
  input logic [4:0]  cycle_i,
  input logic        start_i, learns_i, block_i, guard_i, bad_parity_i, commit_i, ended_i, good_i, timeout_i,
  input logic        weight_valid_i,
  input logic [47:0] weight_i
);

  logic in_reset = 1'b1;
  always @(posedge clk_i) in_reset <= 1'b0;

  learning_t   learning;
  logic [47:0] sum;
  logic        bad_sum;
  block_learning dut (
    .clk_i, .rst_ni (~in_reset), .clear_i, .boundary_i, .cycle_i, .active_i, .start_i, .learns_i, .block_i, .guard_i,
    .bad_parity_i, .commit_i, .ended_i, .good_i, .timeout_i, .learning_o (learning), .weight_valid_i, .weight_i, .sum_o (sum),
    .bad_sum_o (bad_sum)
  );
  (* hierconn *) logic \dut.open_q ;
  (* hierconn *) logic \dut.begun_q ;
  (* hierconn *) logic \dut.within_q ;
  (* hierconn *) logic \dut.bad_parity_q ;
  (* hierconn *) logic [48:0] \dut.sum_read_q ;
  (* hierconn *) logic [2:0] \dut.probe ;
  (* hierconn *) logic [48:0] \dut.probed ;

  // The page's state, and what T3 decides.
  logic open, begun, ended, started;
  logic update, adds, from_sums;
  always @(posedge clk_i) begin
    if (in_reset | clear_i) begin
      {open, begun, ended, started} <= 4'b0010;
    end else if (boundary_i) begin
      started <= start_i;
      ended <= start_i ? 1'b0 : commit_i ? ended_i : ended;
      if (start_i) begin
        {update, adds} <= 2'b00;
        from_sums <= block_i & begun;
        if (~block_i) begin
          update <= learns_i;
          {open, begun} <= 2'b00;
        end else if (~(commit_i ? ended_i : ended)) begin
          adds  <= learns_i & open;
          begun <= begun | (learns_i & open);
        end else begin
          update <= learns_i & begun & (guard_i ? good_i : ~timeout_i);
          {open, begun} <= 2'b10;
        end
      end
    end
  end

  // The watched sum: its cycle of T3's update, and the one at whose end the ring turns it to place 0.
  logic [4:0] written, taken;
  always @* begin
    case (\dut.probe )
      3'd0: {written, taken} = {5'd16, 5'd13};
      3'd1: {written, taken} = {5'd18, 5'd16};
      3'd2: {written, taken} = {5'd19, 5'd18};
      3'd3: {written, taken} = {5'd22, 5'd19};
      3'd4: {written, taken} = {5'd24, 5'd22};
      default: {written, taken} = {5'd25, 5'd24};
    endcase
  end
  logic        known = 1'b0, known_before = 1'b0, active_before = 1'b0;
  logic [4:0]  cycle_before;
  logic [47:0] kept, kept_before;
  logic        wrong, unfit, unfit_before;  // the tick writes, the watched sum has, the wrong parity bit
  always @(posedge clk_i) begin
    known_before  <= known;
    kept_before   <= kept;
    unfit_before  <= unfit;
    if (in_reset) wrong <= 1'b0;
    else if (boundary_i & ~clear_i) wrong <= bad_parity_i;
    active_before <= active_i;
    cycle_before  <= cycle_i;
    if (learning.sum & weight_valid_i & cycle_i == written) begin
      known <= 1'b1;
      kept  <= weight_i;
      unfit <= wrong;
    end
  end

  // The watched sum was taken in this tick, and did not fit its parity bit.
  logic taken_unfit = 1'b0;
  always @(posedge clk_i) begin
    if (boundary_i | in_reset) taken_unfit <= 1'b0;
    else if (started & from_sums & known_before & unfit_before & active_before & cycle_i == taken & cycle_before == taken - 5'd1)
      taken_unfit <= 1'b1;
  end

  always @* begin
    assume (\dut.probe < 3'd6);
    if (taken_unfit) assert (bad_sum);
    assume (~weight_valid_i | cycle_i == 5'd16 | cycle_i == 5'd18 | cycle_i == 5'd19 | cycle_i == 5'd22 | cycle_i == 5'd24 |
            cycle_i == 5'd25);
    if (~in_reset) begin
      assert (\dut.open_q == open & \dut.begun_q == begun & \dut.within_q == ~ended);
      if (started) assert (learning.update == update & learning.sum == adds & learning.from_sums == from_sums);
      assert (\dut.bad_parity_q == wrong);
      // Never both: a sample's update goes to the weights or to the sums.
      assert (~started | ~(learning.update & learning.sum));
    end
    if (known) assert (\dut.probed == {^kept ^ unfit, kept});
    if (known_before & active_before & cycle_i == taken & cycle_before == taken - 5'd1)
      assert (sum == kept_before & \dut.sum_read_q [48] == (^kept_before ^ unfit_before));
  end

endmodule
