// SPDX-License-Identifier: Apache-2.0
// The AHB-Lite side of capsoc_ahb_lite_to_apb.sv: the rules of Arm IHI 0033A for a subordinate, with the clause of each in
// brackets and its content in our words. The manager may do anything except break the two rules assumed below.
module ahb_lite_properties (
  input logic        clk_i,
  input logic        hsel_i, hwrite_i, other_ready_i,
  input logic [11:0] haddr_i,
  input logic [1:0]  htrans_i,
  input logic [2:0]  hsize_i,
  input logic [31:0] hwdata_i,
  input logic        pready_i, pslverr_i,
  input logic [31:0] prdata_i
);

  logic in_reset = 1'b1;
  always @(posedge clk_i) in_reset <= 1'b0;

  logic        hready, hreadyout, hresp, psel, penable, pwrite;
  logic [31:0] hrdata, pwdata;
  logic [11:0] paddr;
  logic [3:0]  pstrb;
  capsoc_ahb_lite_to_apb dut (
    .hclk_i (clk_i), .hresetn_i (~in_reset),
    .hsel_i, .haddr_i, .hwrite_i, .htrans_i, .hsize_i, .hready_i (hready), .hwdata_i,
    .hreadyout_o (hreadyout), .hrdata_o (hrdata), .hresp_o (hresp),
    .psel_o (psel), .penable_o (penable), .pwrite_o (pwrite), .paddr_o (paddr), .pwdata_o (pwdata), .pstrb_o (pstrb),
    .pready_i, .prdata_i, .pslverr_i
  );
  apb_requester_rules #(.MaxWaits (2)) rules (
    .clk_i, .in_reset_i (in_reset), .psel_i (psel), .penable_i (penable), .pwrite_i (pwrite), .pready_i,
    .paddr_i (paddr), .pwdata_i (pwdata), .pstrb_i (pstrb)
  );

  (* hierconn *) logic [1:0] \rules.waits ;
  logic [1:0] apb_waits;
  assign apb_waits = \rules.waits ;

  // The data phase under way, as the address phase before it said; `ours`: this subordinate has to answer it.
  logic        ours, active, write;
  logic [11:0] address;
  logic [2:0]  size;
  // What the transfer has had so far
  logic        setup_made, answered, error_first;
  logic [3:0]  waits;
  logic        first_cycle;
  logic [31:0] hwdata_before;

  // [4.1, 6.1.2] The bus has HREADYOUT of the subordinate whose data phase it is.
  assign hready = ours ? hreadyout : other_ready_i;

  always @(posedge clk_i) begin
    hwdata_before <= hwdata_i;
    first_cycle   <= hready;
    if (in_reset) begin
      ours        <= 1'b0;
      active      <= 1'b0;
      setup_made  <= 1'b0;
      answered    <= 1'b0;
      error_first <= 1'b0;
      waits       <= 4'd0;
    end else begin
      error_first <= hresp & ~hreadyout;
      if (hready) begin
        ours       <= hsel_i;
        active     <= hsel_i & htrans_i[1];
        write      <= hwrite_i;
        address    <= haddr_i;
        size       <= hsize_i;
        setup_made <= 1'b0;
        answered   <= 1'b0;
        waits      <= 4'd0;
      end else if (active) begin
        setup_made <= setup_made | psel;
        answered   <= answered | (psel & penable & pready_i);
        waits      <= waits + 4'd1;
      end
    end
  end

  // [3.4] Bytes on their lanes; a size above the width of the bus, or an address that is not a multiple of it, is none.
  logic       proper;
  logic [3:0] lanes;
  assign proper = size == 3'd0 | (size == 3'd1 & ~address[0]) | (size == 3'd2 & address[1:0] == 2'd0);
  assign lanes  = size == 3'd0 ? 4'd1 << address[1:0] : size == 3'd1 ? 4'd3 << address[1:0] : 4'd15;

  always @* begin
    // [6.1.1] The manager keeps HWDATA through the waits of its data phase.
    if (~in_reset & active & ~first_cycle) assume (hwdata_i == hwdata_before);

    // [7.1.2] In reset HREADYOUT is high.
    if (in_reset) assert (hreadyout & ~hresp);

    if (~in_reset) begin
      // [3.2, table 3-1] IDLE and BUSY, and no select, are answered OKAY without a wait state, and have no effect.
      if (~active) assert (hreadyout & ~hresp & ~psel);

      // [5.1.3] ERROR takes two cycles: HREADYOUT is low in the first and high in the second.
      if (error_first) assert (hresp & hreadyout);
      if (hresp & hreadyout) assert (error_first);

      // A transfer is one transfer of the APB, with the address phase's own address, direction and lanes.
      if (psel) begin
        assert (active & proper & ~answered & ~error_first);
        assert (pwrite == write & paddr == {address[11:2], 2'b00} & pstrb == (write ? lanes : 4'd0));
        if (write) assert (pwdata == hwdata_i);
      end
      if (psel & ~penable) assert (~setup_made);
      // [5.1.1] It ends with the APB's, OKAY, or [5.1.3] with ERROR if the APB said so; one that is not proper always does.
      if (active & hreadyout & ~hresp) assert (proper & psel & penable & pready_i & ~pslverr_i);
      if (active & hreadyout & ~hresp & ~write) assert (hrdata == prdata_i);
      if (active & hresp & ~hreadyout) assert (proper ? psel & penable & pready_i & pslverr_i : ~psel);
      if (active & psel & penable & pready_i) assert (hresp == pslverr_i & hreadyout == ~pslverr_i);
      // [5.1.2] A wait is OKAY, and there are few: setup, the APB's two, the first cycle of ERROR.
      if (~hreadyout & ~hresp) assert (active);
      assert (waits <= 4'd4);
      // For the induction: how far a transfer that waits has come.
      if (active & ~error_first) begin
        assert (setup_made == penable & ~answered);
        if (penable) assert (waits == 4'd1 + {2'd0, apb_waits});
        else assert (waits == 4'd0);
      end
      if (error_first) assert (active & answered == proper);
      if (active) assert (ours);
      if (active & waits == 4'd0) assert (first_cycle);
    end
  end

endmodule
