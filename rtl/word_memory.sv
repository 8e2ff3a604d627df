// SPDX-License-Identifier: Apache-2.0
// Words that only register accesses see: the stages and latches of the 48-bit registers, SOFT_U,
// and a copy of the settings for reading back. A small memory needs far less than registers and
// their part of the read multiplexer; a bit per word tells that it was written since reset.
//
// Latency: a word written at an edge is read after it; reading is combinational. Clearing wins over
// writing.
module word_memory #(
  // Addresses in use; the others have no bit and are never valid.
  parameter logic [31:0] Used = 32'hFFFF_FFFF,
  parameter int Channels = 1
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        clear_i,
  input  logic        we_i,
  input  logic [4:0]  waddr_i,
  input  logic [31:0] wdata_i,
  input  logic [4:0]  raddr_i,
  output logic        valid_o,
  output logic [31:0] rdata_o,
  input  logic               shift_i,
  input  logic        [ 4:0] index_i,
  input  logic [31:0] context_i,  // word index_i in a change; the old one's is rdata_o
  input  chain_t      chain_i,
  output chain_t      chain_o
);

  logic [31:0] valid_q, valid_d;
  logic shift;
  logic [31:0] moved;
  assign shift = Channels > 1 && shift_i;
  context_chain #(.Channels(Channels), .Width(32)) u_chain (
    .kept_i(valid_q), .chain_i, .moved_o(moved), .chain_o
  );

  logic [31:0] words [32];
  logic [31:0] wdata;
  logic [4:0]  waddr, raddr;
  assign waddr = shift ? index_i : waddr_i;
  assign raddr = shift ? index_i : raddr_i;
  assign wdata = shift ? context_i : wdata_i;
  always_ff @(posedge clk_i) begin
    if (we_i | shift) words[waddr] <= wdata;
  end
  assign rdata_o = words[raddr];

`ifdef VERILATOR
  always_ff @(posedge clk_i) begin
    if (rst_ni) assert (~we_i | Used[waddr_i]) else $error("word %0d is written and never shown", waddr_i);
  end
`endif

  always_comb begin
    for (int i = 0; i < 32; i = i + 1) begin
      valid_d[i] = Used[i] & ~clear_i & (valid_q[i] | (we_i & waddr_i == 5'(i)));
    end
  end
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) valid_q <= '0;
    else valid_q <= shift & ~clear_i ? moved : valid_d;
  end
  assign valid_o = valid_q[raddr_i];

`ifdef FORMAL
  // A second reading port, so that a proof can relate one word to its shadow.
  (* anyconst *) logic [4:0] probe;
  logic [31:0] probed;
  assign probed = words[probe];
`endif

endmodule
