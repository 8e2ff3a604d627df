// SPDX-License-Identifier: Apache-2.0
// An example: the coprocessor next to the reference, with a turning sensor and random accesses.
//
//   +samples=N   samples to give, 8 by default: enough to see that the bench runs, too few to judge a design
//
// CAPSOC_DESIGN names another design with the same ports, without parameters: a netlist.
//
// Prints what was compared, and ends by $fatal if anything differs. Pins change at the falling edge: Verilator 5.006 takes a
// nonblocking assignment in an initial process for a blocking one, so at the rising edge the order would be the simulator's.
module capsoc_reference_bench;

  parameter int Paper = 0, Safety = 1;

  logic        pclk = 1'b0, presetn = 1'b1;
  logic        psel = 1'b0, penable = 1'b0, pwrite = 1'b0, pready, pslverr;
  logic [11:0] paddr = '0;
  logic [31:0] pwdata = '0, prdata;
  logic [3:0]  pstrb = '0;
  logic        sample_valid = 1'b0, sample_clip = 1'b0, sample_ready, irq, idle;
  logic [31:0] sample_u = '0, sample_v = '0;

`ifdef CAPSOC_DESIGN
  `CAPSOC_DESIGN dut (
`else
  coprocessor #(.Paper (Paper), .Safety (Safety)) dut (
`endif
    .pclk_i (pclk), .presetn_i (presetn),
    .psel_i (psel), .penable_i (penable), .pwrite_i (pwrite), .paddr_i (paddr), .pwdata_i (pwdata), .pstrb_i (pstrb),
    .pready_o (pready), .prdata_o (prdata), .pslverr_o (pslverr),
    .sample_valid_i (sample_valid), .sample_u_i (sample_u), .sample_v_i (sample_v), .sample_clip_i (sample_clip),
`ifndef CAPSOC_DESIGN
    .sample_channel_i (4'd0),
`endif
    .sample_ready_o (sample_ready), .irq_o (irq), .idle_o (idle)
  );

  capsoc_reference_monitor #(.Paper (Paper), .Safety (Safety)) monitor (
    .pclk_i (pclk), .presetn_i (presetn),
    .psel_i (psel), .penable_i (penable), .pwrite_i (pwrite), .paddr_i (paddr), .pwdata_i (pwdata), .pstrb_i (pstrb),
    .pready_i (pready), .prdata_i (prdata), .pslverr_i (pslverr),
    .sample_valid_i (sample_valid), .sample_u_i (sample_u), .sample_v_i (sample_v), .sample_clip_i (sample_clip),
    .sample_ready_i (sample_ready), .irq_i (irq), .idle_i (idle)
  );

  always #20 pclk = ~pclk;

  // Xorshift (Marsaglia 2003): the same numbers in every simulator.
  logic [31:0] random_q = 32'd2463534242;
  task automatic next_random;
    random_q = random_q ^ (random_q << 13);
    random_q = random_q ^ (random_q >> 17);
    random_q = random_q ^ (random_q << 5);
  endtask

  task automatic access(input logic write, input logic [11:0] address, input logic [31:0] word);
    psel   = 1'b1;
    pwrite = write;
    paddr  = address;
    pwdata = word;
    pstrb  = write ? 4'hF : 4'h0;
    @(negedge pclk);
    penable = 1'b1;
    @(negedge pclk);
    psel    = 1'b0;
    penable = 1'b0;
  endtask

  int  samples, waited;
  real turn;

  // A sensor with an offset and two amplitudes, 1/40 of a turn a sample.
  task automatic give_sample(input int number);
    turn = 6.283185307179586 * (number % 40) / 40.0;
    sample_valid = 1'b1;
    sample_u     = $rtoi((0.03 + 0.60 * $cos(turn)) * 2147483648.0);
    sample_v     = $rtoi((0.55 * $sin(turn + 0.1) - 0.02) * 2147483648.0);
    @(negedge pclk);
    sample_valid = 1'b0;
  endtask

  initial begin
    if (!$value$plusargs("samples=%d", samples)) samples = 8;
    @(negedge pclk);
    presetn = 1'b0;
    repeat (2) @(negedge pclk);
    presetn = 1'b1;
    @(negedge pclk);
    access(1'b1, 12'h01C, 32'd107374182);  // FREQ_HI: 1/40 of a turn a sample
    access(1'b1, 12'h008, 32'h0000_0113);  // CTRL: DEMOD, CALIB, ADC, IE_RESULT
    for (int i = 0; i < samples; i++) begin
      give_sample(i);
      waited = 0;
      while (!irq && waited < 400) begin
        @(negedge pclk);
        waited = waited + 1;
      end
      access(1'b1, 12'h010, 32'h0000_0FFF);  // FLAGS
      for (int address = 'h0B0; address <= 'h0E0; address += 4) access(1'b0, 12'(address), '0);
      // Registers and gaps of the map, and now and then a sample while the first one is under way.
      for (int j = 0; j < 4; j++) begin
        next_random;
        access(1'b0, {4'd0, random_q[5:0], 2'd0}, '0);
        if (random_q[9:8] == 2'd0) access(1'b1, 12'h0A0, random_q);  // SOFT_U
        if (random_q[12:10] == 3'd0) access(1'b1, 12'h0A4, random_q);  // SOFT_V
      end
    end
    repeat (400) @(negedge pclk);
    $display("%0d samples, %0d accesses, %0d intervals: %0d differences", monitor.samples, monitor.accesses, monitor.interval,
             monitor.differences);
    if (samples < 100) $display("a test of the set-up: +samples=1000 for a verdict");
    if (monitor.differences != 0 || monitor.failures != 0) $fatal(1, "design and reference differ");
    $finish;
  end

endmodule
