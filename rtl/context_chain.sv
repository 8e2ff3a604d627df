// SPDX-License-Identifier: Apache-2.0
// A unit's part of the chain through all flip-flops of a channel's context (docs/reference/coprocessor.md, "Channels").
// The chain moves by one word, Width of chain_t, in each clock of a change: the old context leaves it while the new one
// enters. That costs a multiplexer of two for each flip-flop, whatever the number of channels.
//
//   kept_i     the flip-flops; moved_o: what they take over in a clock with change_t.shift
//   chain_i    from the unit before; chain_o: to the next one
// Combinational. Of one channel there is no chain.
module context_chain #(
  parameter int Channels = 1,
  parameter int Width    = 1    // of the unit's flip-flops
) (
  input  logic [Width-1:0] kept_i,
  input  chain_t           chain_i,
  output logic [Width-1:0] moved_o,
  output chain_t           chain_o
);

  if (Channels > 1) begin : g_chain
    assign {chain_o, moved_o} = {kept_i, chain_i};
  end else begin : g_no_chain
    assign {chain_o, moved_o} = '0;
    logic unused_chain;
    assign unused_chain = ^{kept_i, chain_i};
  end

endmodule
