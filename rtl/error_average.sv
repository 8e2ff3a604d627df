// SPDX-License-Identifier: Apache-2.0
// Moving average of both channels' |error| with weight 2^-6, and what it says about the lock.
//
//   error_i    s32, Q1.31, with error_valid_i: in T3 once for u, then once for v
//   average_o  u32, Q1.31, at most 2^31: the larger average, valid from the cycle after v's error
//   lock_o, diverged_o   average below, above its threshold; 0 for the first 63 samples
// sum' = sum + |err| - sum >>r 6 is 64 times the average (u38, Q1.37); average = sum >>r 6.
module error_average #(
  parameter int Channels = 1
) (
  input  logic               clk_i,
  input  logic               rst_ni,
  input  logic               clear_i,
  input  logic               boundary_i,
  input  logic               commit_i,
  input  logic               error_valid_i,
  input  logic signed [31:0] error_i,
  input  logic        [31:0] lock_threshold_i,
  input  logic        [31:0] diverge_threshold_i,
  output logic        [31:0] average_o,
  output logic               lock_o,      // for the sample that enters T4 at this boundary
  output logic               diverged_o,
  input  logic               shift_i,
  input  chain_t             chain_i,
  output chain_t             chain_o
);

  // `other` is the sum of the channel whose turn it is not: each error swaps the two.
  logic [37:0] sum_q, other_q;
  logic empty_q;
  logic [5:0] settled_q;

  logic shift;
  logic [82:0] moved;
  assign shift = Channels > 1 && shift_i;
  context_chain #(.Channels(Channels), .Width(83)) u_chain (
    .kept_i({sum_q, other_q, empty_q, settled_q}), .chain_i, .moved_o(moved), .chain_o
  );

  // Both terms come with a carry: |err| = (err ^ {s}) + s, and -(q + r) = ~q + ~r.
  logic minus;
  logic [37:0] raised, next;
  assign minus = error_i[31];
  add_subtract #(.Width(38)) u_raised (
    .a_i(sum_q), .b_i({{6{minus}}, error_i}), .minus_i(minus), .carry_i(minus), .sum_o(raised)
  );
  add_subtract #(.Width(38)) u_next (
    .a_i(raised), .b_i({6'b0, sum_q[37:6]}), .minus_i(1'b1), .carry_i(~sum_q[5]), .sum_o(next)
  );

  // No reset of the sums: the first boundary after a reset clears them, before any error comes.
  always_ff @(posedge clk_i) begin
    if (boundary_i && empty_q) begin
      sum_q <= '0;
      other_q <= '0;
    end else if (error_valid_i) begin
      sum_q <= other_q;
      other_q <= next;
    end else if (shift) begin
      {sum_q, other_q} <= moved[82:7];
    end
  end

  logic [37:0] larger;
  assign larger = sum_q < other_q ? other_q : sum_q;
  assign average_o = larger[37:6] + 32'(larger[5]);

  logic settled, counting;
  assign counting = settled_q != 6'd63;
  assign settled = !counting || (settled_q == 6'd62 && commit_i);
  assign lock_o = settled && average_o < lock_threshold_i;
  assign diverged_o = settled && average_o > diverge_threshold_i;

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      empty_q <= 1'b1;
      settled_q <= '0;
    end else if (clear_i) begin
      empty_q <= 1'b1;
      settled_q <= '0;
    end else if (shift) begin
      {empty_q, settled_q} <= moved[6:0];
    end else begin
      if (error_valid_i) empty_q <= 1'b0;
      if (commit_i && counting) settled_q <= settled_q + 6'd1;
    end
  end

  logic unused_bits;
  assign unused_bits = ^larger[4:0];

endmodule
