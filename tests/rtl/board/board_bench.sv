// The board's top with short times, and what the bench compares: the transfers of the serial port, and the samples.
module board_bench (
  input  logic        clk_25mhz, btn_pwrn, ftdi_txd, adc_miso,
  output logic        ftdi_rxd, adc_csn, adc_sclk, adc_mosi, wifi_gpio0,
  output logic [7:0]  led,
  // Inside
  output logic        access_o, write_o, error_o, framing_o, sample_valid_o, sample_clip_o, sample_ready_o, refused_o,
  output logic        irq_o, idle_o,
  output logic [11:0] address_o,
  output logic [31:0] wdata_o, rdata_o, sample_u_o, sample_v_o,
  // APB of the coprocessor
  output logic        psel_o, penable_o, pready_o, pwrite_o,
  output logic [11:0] paddr_o
);

  capsoc_board_ulx3s #(
    .ClocksPerBit (9), .QuietClocks (300), .SampleClocks (400), .HalfClocks (2), .StatusClocks (37)
  ) u_board (
    .clk_25mhz, .btn_pwrn, .ftdi_txd, .ftdi_rxd, .led, .adc_csn, .adc_sclk, .adc_mosi, .adc_miso, .wifi_gpio0
  );

  assign access_o       = u_board.host_psel & u_board.host_penable & u_board.host_pready;
  assign write_o        = u_board.host_pwrite;
  assign error_o        = u_board.pslverr;
  assign address_o      = u_board.host_paddr;
  assign wdata_o        = u_board.pwdata;
  assign rdata_o        = u_board.prdata;
  assign framing_o      = u_board.rx_error;
  assign sample_valid_o = u_board.sample_valid;
  assign sample_clip_o  = u_board.sample_clip;
  assign sample_u_o     = u_board.sample_u;
  assign sample_v_o     = u_board.sample_v;
  assign sample_ready_o = u_board.u_coprocessor.sample_ready_o;
  assign refused_o      = u_board.refused;
  assign irq_o          = u_board.irq;
  assign idle_o         = u_board.u_coprocessor.idle_o;
  assign psel_o         = u_board.psel;
  assign penable_o      = u_board.penable;
  assign pready_o       = u_board.pready;
  assign pwrite_o       = u_board.pwrite;
  assign paddr_o        = u_board.paddr;

endmodule
