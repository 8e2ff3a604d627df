// SPDX-License-Identifier: Apache-2.0
// Compares a coprocessor with the reference model at its pins, in every interval of the clock (capsoc_reference.h).
//
// All pins are inputs; the parameters are those of the design. Pins count as they are just before a rising edge, so a bench
// drives them from registers of that clock, or at the falling edge. The comparison begins with the first reset.
// A simulator with DPI, such as Verilator, needs libcapsoc_reference.so. For one with VPI alone, such as Icarus, define
// CAPSOC_REFERENCE_VPI and load capsoc_reference_vpi.c.
`ifdef CAPSOC_REFERENCE_VPI
`define CAPSOC_REFERENCE_HANDLE int
`define CAPSOC_REFERENCE(name) $capsoc_reference_``name
`else
`define CAPSOC_REFERENCE_HANDLE chandle
`define CAPSOC_REFERENCE(name) capsoc_reference_``name
`endif
module capsoc_reference_monitor #(
  parameter int Paper         = 0,
  parameter int OperandBits   = 32,
  parameter int ReferenceLead = 0,
  parameter int StepShift     = 0,
  parameter int PlainArctangent = 0,
  parameter int IterationClocks = 1,
  parameter int Block         = 1,
  parameter int Harmonics     = 1,
  parameter int Safety        = 1,
  parameter int MostMessages  = 20   // differences that are printed; all are counted
) (
  input logic        pclk_i,
  input logic        presetn_i,
  input logic        psel_i,
  input logic        penable_i,
  input logic        pwrite_i,
  input logic [11:0] paddr_i,
  input logic [31:0] pwdata_i,
  input logic [3:0]  pstrb_i,
  input logic        pready_i,
  input logic [31:0] prdata_i,
  input logic        pslverr_i,
  input logic        sample_valid_i,
  input logic [31:0] sample_u_i,
  input logic [31:0] sample_v_i,
  input logic        sample_clip_i,
  input logic        sample_ready_i,
  input logic        irq_i,
  input logic        idle_i
);

`ifndef CAPSOC_REFERENCE_VPI
  import "DPI-C" function chandle capsoc_reference_create(input int paper, input int operand_bits, input int reference_lead,
    input int step_shift, input int plain_arctangent, input int iteration_clocks, input int block, input int harmonics,
    input int safety);
  import "DPI-C" function void capsoc_reference_destroy(input chandle r);
  import "DPI-C" function int capsoc_reference_reset(input chandle r);
  import "DPI-C" function int capsoc_reference_write(input chandle r, input int unsigned address, input int unsigned data,
    input int unsigned strobes, output int unsigned error);
  import "DPI-C" function int capsoc_reference_read(input chandle r, input int unsigned address, output int unsigned data,
    output int unsigned error);
  import "DPI-C" function int capsoc_reference_sample(input chandle r, input int u, input int v, input int clip,
    output int unsigned ready);
  import "DPI-C" function int capsoc_reference_clock(input chandle r, input int unsigned edges);
  import "DPI-C" function int capsoc_reference_outputs(input chandle r, output int unsigned sample_ready,
    output int unsigned irq, output int unsigned idle);
  import "DPI-C" function string capsoc_reference_error(input chandle r);
`endif

  `CAPSOC_REFERENCE_HANDLE reference;
  int          differences = 0, failures = 0, accesses = 0, samples = 0;
  logic [63:0] interval = 0;  // rising edges of the clock so far
  logic        begun = 1'b0;
  int unsigned error, data, ready, irq, idle;

  initial begin
    reference = `CAPSOC_REFERENCE(create)(Paper, OperandBits, ReferenceLead, StepShift, PlainArctangent,
                                           IterationClocks, Block, Harmonics, Safety);
`ifdef CAPSOC_REFERENCE_VPI
    if (reference == 0) $fatal(1, "there is no reference");
`else
    if (reference == null) $fatal(1, "%s", capsoc_reference_error(null));
`endif
  end

  // A call that the reference refused; by VPI it has printed the reason.
  task automatic check(input int code);
    if (code != 0) begin
      failures = failures + 1;
`ifndef CAPSOC_REFERENCE_VPI
      $display("%s", capsoc_reference_error(reference));
`endif
    end
  endtask

  // A word of the design with unknown bits is a difference, too.
  task automatic compare(input logic [31:0] found, input logic [31:0] expected, input logic [8*12-1:0] pin);
    if (found !== expected) begin
      differences = differences + 1;
      if (differences <= MostMessages)
        $display("interval %0d, %0s: design %h, reference %h (address %h)", interval, pin, found, expected, paddr_i);
    end
  endtask

  always @(posedge pclk_i) begin
    interval = interval + 1;
    if (presetn_i !== 1'b1) begin
      begun = 1'b1;
      check(`CAPSOC_REFERENCE(reset)(reference));
    end else if (begun) begin
      check(`CAPSOC_REFERENCE(outputs)(reference, ready, irq, idle));
      compare({31'd0, sample_ready_i}, ready, "sample_ready");
      compare({31'd0, irq_i}, irq, "irq");
      compare({31'd0, idle_i}, idle, "idle");
      if (psel_i & penable_i & pready_i) begin
        accesses = accesses + 1;
        if (pwrite_i) begin
          check(`CAPSOC_REFERENCE(write)(reference, {20'd0, paddr_i}, pwdata_i, {28'd0, pstrb_i}, error));
        end else begin
          check(`CAPSOC_REFERENCE(read)(reference, {20'd0, paddr_i}, data, error));
          if (error == 0) compare(prdata_i, data, "prdata");
        end
        compare({31'd0, pslverr_i}, error, "pslverr");
      end
      if (sample_valid_i) begin
        samples = samples + 1;
        check(`CAPSOC_REFERENCE(sample)(reference, sample_u_i, sample_v_i, {31'd0, sample_clip_i}, ready));
      end
      check(`CAPSOC_REFERENCE(clock)(reference, 1));
    end
  end

endmodule
`undef CAPSOC_REFERENCE_HANDLE
`undef CAPSOC_REFERENCE
