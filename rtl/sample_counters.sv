// SPDX-License-Identifier: Apache-2.0
// SAMPLES and EARLY_COUNT (docs/reference/coprocessor.md, "Sequencer", "Commit").
//
// Latency: an event counts at its edge; clearing wins over it. SAMPLES wraps, EARLY_COUNT stops at
// 2^32 - 1. Two samples can be lost at one edge, one of the stream and one of software.
module sample_counters #(
  parameter int Channels = 1
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        clear_i,
  input  logic        commit_i,
  input  logic        stream_early_i,
  input  logic        soft_early_i,
  output logic [31:0] samples_o,
  output logic [31:0] early_count_o,
  input  logic               shift_i,
  input  chain_t      chain_i,
  output chain_t      chain_o
);

  logic [31:0] samples_q, early_q;

  logic shift;
  logic [63:0] moved;
  assign shift = Channels > 1 && shift_i;
  context_chain #(.Channels(Channels), .Width(64)) u_chain (
    .kept_i({samples_q, early_q}), .chain_i, .moved_o(moved), .chain_o
  );

  // The increment ends the count at its maximum: cheaper than clamping the sum.
  logic       last_pair;
  logic [1:0] early_step;
  assign last_pair = &early_q[31:1];
  always_comb begin
    early_step = {stream_early_i & soft_early_i, stream_early_i ^ soft_early_i};
    if (last_pair) early_step = {1'b0, ~early_q[0]};
  end

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) samples_q <= '0;
    else if (clear_i | commit_i) samples_q <= clear_i ? '0 : samples_q + 32'd1;
    else if (shift) samples_q <= moved[63:32];
  end

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      early_q <= '0;
    end else if (clear_i | stream_early_i | soft_early_i) begin
      early_q <= clear_i ? '0 : early_q + 32'(early_step);
    end else if (shift) begin
      early_q <= moved[31:0];
    end
  end

  assign samples_o     = samples_q;
  assign early_count_o = early_q;

endmodule
