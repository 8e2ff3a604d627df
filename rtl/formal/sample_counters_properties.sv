// SPDX-License-Identifier: Apache-2.0
// The counters against additions in a wider word (sample_counters.sv), from any count.
module sample_counters_properties (
  input logic clk_i, clear_i, commit_i, stream_early_i, soft_early_i
);

  logic in_reset = 1'b1;
  always @(posedge clk_i) in_reset <= 1'b0;

  logic [31:0] samples, early_count;
  sample_counters dut (
    .clk_i, .rst_ni (~in_reset), .clear_i, .commit_i, .stream_early_i, .soft_early_i,
    .samples_o (samples), .early_count_o (early_count)
  );

  // What the counters have to be after the edge. Before it anything, so that a maximum is no
  // 2^32 steps away: the first step of an induction starts from any count.
  logic [31:0] samples_due, early_due;
  logic [33:0] sum;
  assign sum = {2'd0, early_count} + {33'd0, stream_early_i} + {33'd0, soft_early_i};
  always @(posedge clk_i) begin
    samples_due <= in_reset | clear_i ? 32'd0 : samples + {31'd0, commit_i};
    early_due   <= in_reset | clear_i ? 32'd0 : |sum[33:32] ? 32'hFFFF_FFFF : sum[31:0];
  end
  always @* if (~in_reset) assert (samples == samples_due & early_count == early_due);

endmodule
