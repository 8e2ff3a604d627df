// SPDX-License-Identifier: Apache-2.0
// Idle safety of the whole design: with idle_o = 1 and neither a sample nor a transfer, no register
// changes. It is what allows a simulation to skip the clock edges between samples. scripts/tool formal
// asserts of every register that it keeps its value while `quiet` is 1.
module idle_properties #(
  parameter int Paper = 0,
  parameter int Safety = 1,
  parameter int IterationClocks = 1
) (
  input logic        clk_i,
  input logic        psel_i, penable_i, pwrite_i,
  input logic [11:0] paddr_i,
  input logic [31:0] pwdata_i,
  input logic [3:0]  pstrb_i,
  input logic        sample_valid_i, sample_clip_i,
  input logic [31:0] sample_u_i, sample_v_i
);

  logic in_reset = 1'b1;
  always @(posedge clk_i) in_reset <= 1'b0;

  logic        pready, pslverr, sample_ready, irq, idle;
  logic [31:0] prdata;
  coprocessor #(.Paper (Paper), .Safety (Safety), .IterationClocks (IterationClocks)) dut (
    .pclk_i (clk_i), .presetn_i (~in_reset),
    .psel_i, .penable_i, .pwrite_i, .paddr_i, .pwdata_i, .pstrb_i,
    .pready_o (pready), .prdata_o (prdata), .pslverr_o (pslverr),
    .sample_valid_i, .sample_u_i, .sample_v_i, .sample_clip_i, .sample_channel_i (4'd0),
    .sample_ready_o (sample_ready), .irq_o (irq), .idle_o (idle)
  );

  // What the step needs to know of the states before: the cycle counter rests at 0 outside ticks.
  (* hierconn *) logic [4:0] \dut.u_sequencer.stage_q ;
  (* hierconn *) logic [2:0] \dut.u_sequencer.load_q ;
  (* hierconn *) logic [IterationClocks == 2 ? 5 : 4:0] \dut.u_sequencer.cycle_q ;
  logic running;
  assign running = (|\dut.u_sequencer.stage_q ) | (|\dut.u_sequencer.load_q );
  always @* if (~in_reset & ~running) assert (\dut.u_sequencer.cycle_q == '0);

  (* keep *) logic quiet;
  assign quiet = ~in_reset & idle & ~sample_valid_i & ~(psel_i & penable_i);

endmodule
