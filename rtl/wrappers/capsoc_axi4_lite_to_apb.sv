// SPDX-License-Identifier: Apache-2.0
// AXI4-Lite subordinate (Arm IHI 0022E) that makes one APB transfer (IHI 0024C) of each write and each read. One clock for both.
//
// Each of the five channels has one place: an address, data or a response waits there. A write begins when its address and its
// data are there, in whichever order they came, and the place of its response is free; a read likewise. Where both could
// begin, the write does; its response then leaves the next turn to the read.
// Latency: a response is valid three edges after the edge that takes the last of its request, later with waits of PREADY.
// Every output of a channel is a register's: no path leads from an input to one of them.
// Lanes: PADDR is the address of the word, PSTRB is WSTRB and 0 in reads. PSLVERR becomes SLVERR.
// AWPROT and ARPROT have no effect.
module capsoc_axi4_lite_to_apb (
  input  logic        aclk_i,
  input  logic        aresetn_i,
  // AXI4-Lite
  input  logic        awvalid_i,
  output logic        awready_o,
  input  logic [11:0] awaddr_i,
  input  logic [2:0]  awprot_i,
  input  logic        wvalid_i,
  output logic        wready_o,
  input  logic [31:0] wdata_i,
  input  logic [3:0]  wstrb_i,
  output logic        bvalid_o,
  input  logic        bready_i,
  output logic [1:0]  bresp_o,
  input  logic        arvalid_i,
  output logic        arready_o,
  input  logic [11:0] araddr_i,
  input  logic [2:0]  arprot_i,
  output logic        rvalid_o,
  input  logic        rready_i,
  output logic [31:0] rdata_o,
  output logic [1:0]  rresp_o,
  // APB
  output logic        psel_o,
  output logic        penable_o,
  output logic        pwrite_o,
  output logic [11:0] paddr_o,
  output logic [31:0] pwdata_o,
  output logic [3:0]  pstrb_o,
  input  logic        pready_i,
  input  logic [31:0] prdata_i,
  input  logic        pslverr_i
);

  // The places of the channels
  logic        aw_full_q, w_full_q, ar_full_q, bvalid_q, rvalid_q, berror_q, rerror_q;
  logic [9:0]  aw_word_q, ar_word_q;
  logic [31:0] wdata_q, rdata_q;
  logic [3:0]  wstrb_q;
  // The APB transfer
  logic psel_q, penable_q, pwrite_q;
  logic can_write, can_read, begins, ends, write_ends, read_ends;

  assign can_write  = aw_full_q & w_full_q & ~bvalid_q;
  assign can_read   = ar_full_q & ~rvalid_q;
  assign begins     = ~psel_q & (can_write | can_read);
  assign ends       = psel_q & penable_q & pready_i;
  assign write_ends = ends & pwrite_q;
  assign read_ends  = ends & ~pwrite_q;

  always_ff @(posedge aclk_i or negedge aresetn_i) begin
    if (!aresetn_i) begin
      psel_q    <= 1'b0;
      penable_q <= 1'b0;
      pwrite_q  <= 1'b0;
    end else begin
      psel_q    <= begins | (psel_q & ~ends);
      penable_q <= psel_q & ~ends;
      if (begins) pwrite_q <= can_write;
    end
  end

  always_ff @(posedge aclk_i or negedge aresetn_i) begin
    if (!aresetn_i) begin
      aw_full_q <= 1'b0;
      w_full_q  <= 1'b0;
      ar_full_q <= 1'b0;
      bvalid_q  <= 1'b0;
      rvalid_q  <= 1'b0;
      berror_q  <= 1'b0;
      rerror_q  <= 1'b0;
      aw_word_q <= '0;
      ar_word_q <= '0;
      wdata_q   <= '0;
      rdata_q   <= '0;
      wstrb_q   <= '0;
    end else begin
      aw_full_q <= aw_full_q ? ~write_ends : awvalid_i;
      w_full_q  <= w_full_q ? ~write_ends : wvalid_i;
      ar_full_q <= ar_full_q ? ~read_ends : arvalid_i;
      bvalid_q  <= bvalid_q ? ~bready_i : write_ends;
      rvalid_q  <= rvalid_q ? ~rready_i : read_ends;
      if (awvalid_i & ~aw_full_q) aw_word_q <= awaddr_i[11:2];
      if (arvalid_i & ~ar_full_q) ar_word_q <= araddr_i[11:2];
      if (wvalid_i & ~w_full_q) begin
        wdata_q <= wdata_i;
        wstrb_q <= wstrb_i;
      end
      if (write_ends) berror_q <= pslverr_i;
      if (read_ends) begin
        rdata_q  <= prdata_i;
        rerror_q <= pslverr_i;
      end
    end
  end

  assign awready_o = ~aw_full_q;
  assign wready_o  = ~w_full_q;
  assign arready_o = ~ar_full_q;
  assign bvalid_o  = bvalid_q;
  assign bresp_o   = {berror_q, 1'b0};
  assign rvalid_o  = rvalid_q;
  assign rdata_o   = rdata_q;
  assign rresp_o   = {rerror_q, 1'b0};

  assign psel_o    = psel_q;
  assign penable_o = penable_q;
  assign pwrite_o  = pwrite_q;
  assign paddr_o   = {pwrite_q ? aw_word_q : ar_word_q, 2'b00};
  assign pwdata_o  = wdata_q;
  assign pstrb_o   = wstrb_q & {4{pwrite_q}};

  logic unused_bits;
  assign unused_bits = ^{awprot_i, arprot_i, awaddr_i[1:0], araddr_i[1:0]};

endmodule
