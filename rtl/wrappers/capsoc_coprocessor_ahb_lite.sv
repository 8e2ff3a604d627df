// SPDX-License-Identifier: Apache-2.0
// The self-calibration coprocessor (coprocessor.sv) as an AHB-Lite subordinate with a sample port. HCLK is its clock.
//
// Bus: capsoc_ahb_lite_to_apb.sv says latency, lanes and errors. Registers are written by whole words: a narrower write is
// an ERROR. A write acts at the edge that ends its data phase. A read shows what the edge before left.
module capsoc_coprocessor_ahb_lite #(
  parameter int Paper         = 0,   // 0: arithmetic `precise`, 1: `paper`
  parameter int OperandBits   = 32,  // paper: width of the arctangent's operands, 2..32
  parameter int ReferenceLead = 0,   // paper: samples by which the reference leads the data
  parameter int StepShift     = 0,   // paper: right shift of the steps, 0..31
  parameter int PlainArctangent = 0, // paper: the arctangent's input as it is
  parameter int IterationClocks = 1, // paper: clocks of an iteration of the arctangent, 1 or 2
  parameter int Block         = 1,   // precise: block learning, CTRL.BLOCK and GUARD
  parameter int Harmonics     = 1,   // precise: harmonic correction, CTRL.CORRECT and CORRECTION
  parameter int Safety        = 1,   // safety mechanisms, SAFETY and parity bits
  parameter int Channels      = 1    // sensors that share the pipeline, 1..16
) (
  input  logic        hclk_i,
  input  logic        hresetn_i,
  // AHB-Lite
  input  logic        hsel_i,
  input  logic [11:0] haddr_i,
  input  logic        hwrite_i,
  input  logic [1:0]  htrans_i,
  input  logic [2:0]  hsize_i,
  input  logic        hready_i,
  input  logic [31:0] hwdata_i,
  output logic        hreadyout_o,
  output logic [31:0] hrdata_o,
  output logic        hresp_o,
  // ADC stream
  input  logic        sample_valid_i,
  input  logic [31:0] sample_u_i,
  input  logic [31:0] sample_v_i,
  input  logic        sample_clip_i,
  input  logic [3:0]  sample_channel_i,  // with several channels: whose it is
  output logic        sample_ready_o,  // a sample of this interval will be latched
  output logic        irq_o,
  output logic        idle_o           // nothing changes at the coming edge of itself
);

  logic        psel, penable, pwrite, pready, pslverr;
  logic [11:0] paddr;
  logic [31:0] pwdata, prdata;
  logic [3:0]  pstrb;

  capsoc_ahb_lite_to_apb u_bus (
    .hclk_i, .hresetn_i,
    .hsel_i, .haddr_i, .hwrite_i, .htrans_i, .hsize_i, .hready_i, .hwdata_i, .hreadyout_o, .hrdata_o, .hresp_o,
    .psel_o          (psel),
    .penable_o       (penable),
    .pwrite_o        (pwrite),
    .paddr_o         (paddr),
    .pwdata_o        (pwdata),
    .pstrb_o         (pstrb),
    .pready_i        (pready),
    .prdata_i        (prdata),
    .pslverr_i       (pslverr)
  );

  coprocessor #(
    .Paper           (Paper),
    .OperandBits     (OperandBits),
    .ReferenceLead   (ReferenceLead),
    .StepShift       (StepShift),
    .PlainArctangent (PlainArctangent),
    .IterationClocks (IterationClocks),
    .Block           (Block),
    .Harmonics       (Harmonics),
    .Safety          (Safety),
    .Channels        (Channels)
  ) u_coprocessor (
    .pclk_i          (hclk_i),
    .presetn_i       (hresetn_i),
    .psel_i          (psel),
    .penable_i       (penable),
    .pwrite_i        (pwrite),
    .paddr_i         (paddr),
    .pwdata_i        (pwdata),
    .pstrb_i         (pstrb),
    .pready_o        (pready),
    .prdata_o        (prdata),
    .pslverr_o       (pslverr),
    .sample_valid_i, .sample_u_i, .sample_v_i, .sample_clip_i, .sample_channel_i, .sample_ready_o, .irq_o, .idle_o
  );

endmodule
