// SPDX-License-Identifier: Apache-2.0
// The self-calibration coprocessor on the board ULX3S: registers at the serial port, samples from the board's ADC.
//
// Clock: 25 MHz, the board's oscillator. Reset: the power button, and two clocks after the configuration, which leaves
// the flip-flops as their reset does. Ports have the names of the board's constraints; ulx3s.lpf says the sites.
// Latency and formats: capsoc_serial_to_apb.sv (commands), capsoc_adc_max11125.sv (samples), coprocessor.sv (results).
// The command S returns 31:16 pairs that the ADC's controller refused, 15:0 pairs that it gave; both wrap.
// LEDs 0 to 3 show LOCK, VALID, ALARM and DIVERGED of STATUS, and 4 the interrupt. 5 changes with every 128th pair.
// 6: a code was at a rail within the last 255 pairs. 7: a pair was refused since the reset.
module capsoc_board_ulx3s #(
  parameter int ClocksPerBit  = 217,     // of the serial line: 115,200 bit/s
  parameter int QuietClocks   = 262144,  // after which a half command is dropped: 10 ms
  parameter int SampleClocks  = 100000,  // between two pairs: 250 Hz
  parameter int HalfClocks    = 2,       // half a period of the ADC's SCLK: 6.25 MHz
  parameter int ChannelU      = 0,       // the ADC's input with the sine
  parameter int ChannelV      = 1,       // the ADC's input with the cosine
  parameter int ChannelRest   = 7,       // an input that is neither
  parameter int StatusClocks  = 65536,   // between two reads of STATUS for the LEDs
  parameter int Paper         = 0,       // 0: arithmetic `precise`, 1: `paper`
  parameter int OperandBits   = 32,      // paper: width of the arctangent's operands, 2..32
  parameter int ReferenceLead = 0,       // paper: samples by which the reference leads the data
  parameter int StepShift     = 0,       // paper: right shift of the steps, 0..31
  parameter int PlainArctangent = 0,     // paper: the arctangent's input as it is
  parameter int IterationClocks = 1,     // paper: clocks of an iteration of the arctangent, 1 or 2
  parameter int Block         = 1,       // precise: block learning, CTRL.BLOCK and GUARD
  parameter int Harmonics     = 1,       // precise: harmonic correction, CTRL.CORRECT and CORRECTION
  parameter int Safety        = 1        // safety mechanisms, SAFETY and parity bits
) (
  input  logic       clk_25mhz,
  input  logic       btn_pwrn,    // power button, 0 while it is pressed
  input  logic       ftdi_txd,    // from the host
  output logic       ftdi_rxd,    // to the host
  output logic [7:0] led,
  output logic       adc_csn,
  output logic       adc_sclk,
  output logic       adc_mosi,
  input  logic       adc_miso,
  output logic       wifi_gpio0   // 1: the ESP32 does not restart the board
);

  assign wifi_gpio0 = 1'b1;

  // Reset: at once, and released with the clock
  logic [1:0] reset_q;
  logic       rst_n;
  always_ff @(posedge clk_25mhz or negedge btn_pwrn) begin
    if (!btn_pwrn) reset_q <= 2'b00;
    else reset_q <= {reset_q[0], 1'b1};
  end
  assign rst_n = reset_q[1];

  // Serial port
  logic       rx_valid, rx_error, rx_busy, tx_valid, tx_ready;
  logic [7:0] rx_data, tx_data;

  capsoc_serial_receiver #(.ClocksPerBit(ClocksPerBit)) u_receiver (
    .clk_i (clk_25mhz), .rst_ni (rst_n), .serial_i (ftdi_txd),
    .valid_o (rx_valid), .data_o (rx_data), .error_o (rx_error), .busy_o (rx_busy)
  );

  capsoc_serial_transmitter #(.ClocksPerBit(ClocksPerBit)) u_transmitter (
    .clk_i (clk_25mhz), .rst_ni (rst_n),
    .valid_i (tx_valid), .data_i (tx_data), .ready_o (tx_ready), .serial_o (ftdi_rxd)
  );

  // APB: of the serial port, and with the reads of STATUS among its transfers
  logic        host_psel, host_penable, host_pwrite, host_pready, psel, penable, pwrite, pready, pslverr;
  logic [11:0] host_paddr, paddr;
  logic [3:0]  host_pstrb, pstrb;
  logic [31:0] pwdata, prdata, status;
  logic [15:0] given_q, refused_q;

  capsoc_serial_to_apb #(.QuietClocks(QuietClocks)) u_serial_to_apb (
    .clk_i (clk_25mhz), .rst_ni (rst_n),
    .rx_valid_i (rx_valid), .rx_data_i (rx_data), .rx_error_i (rx_error), .rx_busy_i (rx_busy),
    .tx_valid_o (tx_valid), .tx_data_o (tx_data), .tx_ready_i (tx_ready), .word_i ({refused_q, given_q}),
    .psel_o (host_psel), .penable_o (host_penable), .pwrite_o (host_pwrite), .paddr_o (host_paddr), .pwdata_o (pwdata),
    .pstrb_o (host_pstrb), .pready_i (host_pready), .prdata_i (prdata), .pslverr_i (pslverr)
  );

  capsoc_status_reader #(.Interval(StatusClocks)) u_status_reader (
    .clk_i (clk_25mhz), .rst_ni (rst_n),
    .psel_i (host_psel), .penable_i (host_penable), .pwrite_i (host_pwrite), .paddr_i (host_paddr),
    .pstrb_i (host_pstrb), .pready_o (host_pready),
    .psel_o (psel), .penable_o (penable), .pwrite_o (pwrite), .paddr_o (paddr), .pstrb_o (pstrb),
    .pready_i (pready), .prdata_i (prdata), .status_o (status)
  );

  // Samples
  logic        sample_valid, sample_clip, refused, irq;
  logic [31:0] sample_u, sample_v;

  capsoc_adc_max11125 #(
    .SampleClocks (SampleClocks),
    .HalfClocks   (HalfClocks),
    .ChannelU     (ChannelU),
    .ChannelV     (ChannelV),
    .ChannelRest  (ChannelRest)
  ) u_adc (
    .clk_i (clk_25mhz), .rst_ni (rst_n),
    .csn_o (adc_csn), .sclk_o (adc_sclk), .mosi_o (adc_mosi), .miso_i (adc_miso),
    .sample_valid_o (sample_valid), .sample_u_o (sample_u), .sample_v_o (sample_v), .sample_clip_o (sample_clip),
    .refused_o (refused)
  );

  logic unused_sample_ready, unused_idle;
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
    .Channels        (1)
  ) u_coprocessor (
    .pclk_i (clk_25mhz), .presetn_i (rst_n),
    .psel_i (psel), .penable_i (penable), .pwrite_i (pwrite), .paddr_i (paddr), .pwdata_i (pwdata), .pstrb_i (pstrb),
    .pready_o (pready), .prdata_o (prdata), .pslverr_o (pslverr),
    .sample_valid_i (sample_valid), .sample_u_i (sample_u), .sample_v_i (sample_v), .sample_clip_i (sample_clip),
    .sample_channel_i (4'd0), .sample_ready_o (unused_sample_ready), .irq_o (irq), .idle_o (unused_idle)
  );

  // LEDs
  logic [7:0] clip_q;  // pairs for which the LED stays on
  logic       fault_q;
  always_ff @(posedge clk_25mhz or negedge rst_n) begin
    if (!rst_n) begin
      given_q   <= '0;
      refused_q <= '0;
      clip_q    <= '0;
      fault_q   <= 1'b0;
    end else begin
      if (sample_valid) begin
        given_q <= given_q + 1'b1;
        if (sample_clip) clip_q <= '1;
        else if (clip_q != '0) clip_q <= clip_q - 1'b1;
      end
      if (refused) begin
        refused_q <= refused_q + 1'b1;
        fault_q   <= 1'b1;
      end
    end
  end
  assign led = {fault_q, clip_q != '0, given_q[7], irq, status[2], status[5], status[4], status[1]};

  logic unused_status;
  assign unused_status = ^{status[31:6], status[3], status[0]};

endmodule
