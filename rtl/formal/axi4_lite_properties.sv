// SPDX-License-Identifier: Apache-2.0
// The AXI4-Lite side of capsoc_axi4_lite_to_apb.sv: the rules of Arm IHI 0022E for a subordinate, with the clause of each in
// brackets and its content in our words. Nothing is assumed of the manager. That no path leads from an input of a channel to
// an output [A3.1.1] is a check of the netlist: scripts/tool lint_rtl.
module axi4_lite_properties (
  input logic        clk_i,
  input logic        awvalid_i, wvalid_i, bready_i, arvalid_i, rready_i,
  input logic [11:0] awaddr_i, araddr_i,
  input logic [2:0]  awprot_i, arprot_i,
  input logic [31:0] wdata_i,
  input logic [3:0]  wstrb_i,
  input logic        pready_i, pslverr_i,
  input logic [31:0] prdata_i
);

  logic in_reset = 1'b1;
  always @(posedge clk_i) in_reset <= 1'b0;

  logic        awready, wready, bvalid, arready, rvalid, psel, penable, pwrite;
  logic [1:0]  bresp, rresp;
  logic [31:0] rdata, pwdata;
  logic [11:0] paddr;
  logic [3:0]  pstrb;
  capsoc_axi4_lite_to_apb dut (
    .aclk_i (clk_i), .aresetn_i (~in_reset),
    .awvalid_i, .awready_o (awready), .awaddr_i, .awprot_i,
    .wvalid_i, .wready_o (wready), .wdata_i, .wstrb_i,
    .bvalid_o (bvalid), .bready_i, .bresp_o (bresp),
    .arvalid_i, .arready_o (arready), .araddr_i, .arprot_i,
    .rvalid_o (rvalid), .rready_i, .rdata_o (rdata), .rresp_o (rresp),
    .psel_o (psel), .penable_o (penable), .pwrite_o (pwrite), .paddr_o (paddr), .pwdata_o (pwdata), .pstrb_o (pstrb),
    .pready_i, .prdata_i, .pslverr_i
  );
  apb_requester_rules #(.MaxWaits (2)) rules (
    .clk_i, .in_reset_i (in_reset), .psel_i (psel), .penable_i (penable), .pwrite_i (pwrite), .pready_i,
    .paddr_i (paddr), .pwdata_i (pwdata), .pstrb_i (pstrb)
  );

  (* hierconn *) logic [1:0]  \rules.waits ;
  (* hierconn *) logic [9:0]  \dut.aw_word_q ;
  (* hierconn *) logic [9:0]  \dut.ar_word_q ;
  (* hierconn *) logic [31:0] \dut.wdata_q ;
  (* hierconn *) logic [3:0]  \dut.wstrb_q ;
  logic [3:0] phase;  // of the transfer of the APB: 1 setup, 2 to 4 access
  assign phase = ~psel ? 4'd0 : ~penable ? 4'd1 : 4'd2 + {2'd0, \rules.waits };

  // Requests that were taken and not carried out yet, and responses that are due.
  logic        aw_open, w_open, ar_open, b_due, r_due;
  logic [11:0] aw_address, ar_address;
  logic [31:0] w_data, r_data;
  logic [3:0]  w_strobes;
  logic        b_error, r_error, write_done, read_done;
  assign write_done = psel & penable & pready_i & pwrite;
  assign read_done  = psel & penable & pready_i & ~pwrite;

  // How long a write and a read that could be carried out have waited.
  logic [3:0] write_age, read_age;

  always @(posedge clk_i) begin
    if (in_reset) begin
      {aw_open, w_open, ar_open, b_due, r_due} <= 5'd0;
      {write_age, read_age} <= 8'd0;
    end else begin
      // [A3.2.1] A transfer of a channel is an edge at which VALID and READY are high.
      aw_open <= (aw_open & ~write_done) | (awvalid_i & awready);
      w_open  <= (w_open & ~write_done) | (wvalid_i & wready);
      ar_open <= (ar_open & ~read_done) | (arvalid_i & arready);
      b_due   <= (b_due & ~(bvalid & bready_i)) | write_done;
      r_due   <= (r_due & ~(rvalid & rready_i)) | read_done;
      if (awvalid_i & awready) aw_address <= awaddr_i;
      if (arvalid_i & arready) ar_address <= araddr_i;
      if (wvalid_i & wready) {w_data, w_strobes} <= {wdata_i, wstrb_i};
      if (write_done) b_error <= pslverr_i;
      if (read_done) {r_error, r_data} <= {pslverr_i, prdata_i};
      write_age <= aw_open & w_open & ~b_due & ~write_done ? write_age + 4'd1 : 4'd0;
      read_age  <= ar_open & ~r_due & ~read_done ? read_age + 4'd1 : 4'd0;
    end
  end

  always @* begin
    // [A3.1.2] In reset BVALID and RVALID are low.
    if (in_reset) assert (~bvalid & ~rvalid);

    if (~in_reset) begin
      // [A3.3.1] A response is there only after its request: BVALID after both AW and W, in any order, RVALID after AR. One each.
      // [A3.2.1] VALID stays until READY, and with it what the channel says; neither waits for READY.
      assert (bvalid == b_due);
      assert (rvalid == r_due);
      // [A3.4.4, B1.1] OKAY or SLVERR; there is no EXOKAY, and no DECERR of a subordinate.
      if (bvalid) assert (bresp == {b_error, 1'b0});
      if (rvalid) assert (rresp == {r_error, 1'b0} & rdata == r_data);

      // A channel has one place: it takes nothing more while that is full, and always something while it is empty.
      assert (awready == ~aw_open);
      assert (wready == ~w_open);
      assert (arready == ~ar_open);

      // A write is one transfer of the APB, with its own address and data and [A3.4.3, B1.1.3] its own strobes; a read as well.
      // [A3.3.1] It waits for the place of its response.
      if (psel & pwrite) begin
        assert (aw_open & w_open & ~b_due);
        assert (paddr == {aw_address[11:2], 2'b00} & pwdata == w_data & pstrb == w_strobes);
      end
      if (psel & ~pwrite) assert (ar_open & ~r_due & paddr == {ar_address[11:2], 2'b00});

      // The same while they wait, for the induction.
      if (aw_open) assert (\dut.aw_word_q  == aw_address[11:2]);
      if (ar_open) assert (\dut.ar_word_q  == ar_address[11:2]);
      if (w_open) assert (\dut.wdata_q  == w_data & \dut.wstrb_q  == w_strobes);

      // Nothing waits for ever: a transfer of the APB takes at most four cycles and one to begin, and before it comes at most one
      // of the other kind. PWRITE keeps the kind of the last one.
      assert (write_age <= (~psel ? (pwrite ? 4'd0 : 4'd5) : pwrite ? 4'd5 + phase : phase));
      assert (read_age <= (~psel ? (pwrite ? 4'd5 : 4'd0) : pwrite ? phase : 4'd5 + phase));
    end
  end

endmodule
