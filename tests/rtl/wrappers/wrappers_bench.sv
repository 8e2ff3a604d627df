// Both tops of rtl/wrappers around one clock, each with its own sample port. The AHB-Lite one has the parameters by default, the
// AXI4-Lite one those of the SoC paper's Table 8.
module wrappers_bench (
  input  logic        clk_i, rst_ni,
  input  logic        hsel_i, hwrite_i, hready_i,
  input  logic [11:0] haddr_i,
  input  logic [1:0]  htrans_i,
  input  logic [2:0]  hsize_i,
  input  logic [31:0] hwdata_i,
  output logic        hreadyout_o, hresp_o,
  output logic [31:0] hrdata_o,
  input  logic        ahb_sample_valid_i, ahb_sample_clip_i,
  input  logic [31:0] ahb_sample_u_i, ahb_sample_v_i,
  output logic        ahb_sample_ready_o, ahb_irq_o, ahb_idle_o,
  input  logic        awvalid_i, wvalid_i, bready_i, arvalid_i, rready_i,
  input  logic [11:0] awaddr_i, araddr_i,
  input  logic [2:0]  awprot_i, arprot_i,
  input  logic [31:0] wdata_i,
  input  logic [3:0]  wstrb_i,
  output logic        awready_o, wready_o, bvalid_o, arready_o, rvalid_o,
  output logic [1:0]  bresp_o, rresp_o,
  output logic [31:0] rdata_o,
  input  logic        axi_sample_valid_i, axi_sample_clip_i,
  input  logic [31:0] axi_sample_u_i, axi_sample_v_i,
  output logic        axi_sample_ready_o, axi_irq_o, axi_idle_o
);

  capsoc_coprocessor_ahb_lite u_ahb_lite (
    .hclk_i (clk_i), .hresetn_i (rst_ni),
    .hsel_i, .haddr_i, .hwrite_i, .htrans_i, .hsize_i, .hready_i, .hwdata_i, .hreadyout_o, .hrdata_o, .hresp_o,
    .sample_valid_i (ahb_sample_valid_i), .sample_u_i (ahb_sample_u_i), .sample_v_i (ahb_sample_v_i),
    .sample_clip_i (ahb_sample_clip_i), .sample_channel_i (4'd0), .sample_ready_o (ahb_sample_ready_o), .irq_o (ahb_irq_o), .idle_o (ahb_idle_o)
  );

  capsoc_coprocessor_axi4_lite #(
    .Paper (1), .OperandBits (16), .ReferenceLead (2), .StepShift (7), .PlainArctangent (1)
  ) u_axi4_lite (
    .aclk_i (clk_i), .aresetn_i (rst_ni),
    .awvalid_i, .awready_o, .awaddr_i, .awprot_i, .wvalid_i, .wready_o, .wdata_i, .wstrb_i, .bvalid_o, .bready_i, .bresp_o,
    .arvalid_i, .arready_o, .araddr_i, .arprot_i, .rvalid_o, .rready_i, .rdata_o, .rresp_o,
    .sample_valid_i (axi_sample_valid_i), .sample_u_i (axi_sample_u_i), .sample_v_i (axi_sample_v_i),
    .sample_clip_i (axi_sample_clip_i), .sample_channel_i (4'd0), .sample_ready_o (axi_sample_ready_o), .irq_o (axi_irq_o), .idle_o (axi_idle_o)
  );

endmodule
