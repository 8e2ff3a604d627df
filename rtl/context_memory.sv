// SPDX-License-Identifier: Apache-2.0
// The contexts of all channels, 32 words of each: a word of the chain of flip-flops, and of each memory of words that the
// units have for one channel. Block memory with a reading and a writing port.
//
// Latency: a word is there in the interval after the edge that reads it. Written words are never read at the same edge,
// because a change writes one channel's and reads another's. No reset: a context is written before it is read, except the
// first one of a channel after a reset, which channel_control.sv does not use.
module context_memory #(
  parameter int Channels = 2  // to 16
) (
  input  logic       clk_i,
  input  logic       read_i,
  input  logic [3:0] read_channel_i,
  input  logic [4:0] read_index_i,
  output context_t   context_o,
  input  logic       write_i,
  input  logic [3:0] write_channel_i,
  input  logic [4:0] write_index_i,
  input  context_t   context_i
);

  localparam int Bits = $clog2(Channels);

  localparam int Width = 169;  // of context_t
  logic [Width-1:0] contexts[0:32*Channels-1];
  logic [Width-1:0] context_q;
  always_ff @(posedge clk_i) begin
    if (write_i) contexts[{write_channel_i[Bits-1:0], write_index_i}] <= context_i;
    if (read_i) context_q <= contexts[{read_channel_i[Bits-1:0], read_index_i}];
  end
  assign context_o = context_q;

`ifdef FORMAL
  // A second reading port, so that a proof can relate a word to its shadow.
  (* anyconst *) logic [Bits+4:0] probe;
  logic [Width-1:0] probed;
  assign probed = contexts[probe];
`endif

  if (Bits < 4) begin : g_few
    logic unused_bits;
    assign unused_bits = ^{read_channel_i[3:Bits], write_channel_i[3:Bits]};
  end

endmodule
