// SPDX-License-Identifier: Apache-2.0
// Self-calibration coprocessor (docs/reference/coprocessor.md): an APB slave with a sample port.
//
// Latency: a sample is committed 161 cycles after the edge that latches it, up to 31 more if it has
// to wait for a tick boundary. In `paper` with IterationClocks = 2 it is 321, and up to 63 more. APB: no wait states.
// Formats: sample words Q1.31, two's complement; registers as documented.
// Order at one edge: ends of ticks, starts of ticks, the sample, the register access.
module coprocessor #(
  parameter int Paper         = 0,   // 0: arithmetic `precise`, 1: `paper`
  parameter int OperandBits   = 32,  // paper: width of the arctangent's operands, 2..32
  parameter int ReferenceLead = 0,   // paper: samples by which the reference leads the data
  parameter int StepShift     = 0,   // paper: right shift of the steps, 0..31
  parameter int PlainArctangent = 0, // paper: the arctangent's input as it is
  parameter int IterationClocks = 1, // paper: clocks of an iteration of the arctangent, 1 or 2
  parameter int Block         = 1,   // precise: block learning, CTRL.BLOCK and GUARD
  parameter int Harmonics     = 1,   // precise: harmonic correction, CTRL.CORRECT and CORRECTION
  parameter int Safety        = 1    // safety mechanisms, SAFETY and parity bits
) (
  input  logic        pclk_i,
  input  logic        presetn_i,
  // APB; only 32-bit writes
  input  logic        psel_i,
  input  logic        penable_i,
  input  logic        pwrite_i,
  input  logic [11:0] paddr_i,
  input  logic [31:0] pwdata_i,
  input  logic [3:0]  pstrb_i,
  output logic        pready_o,
  output logic [31:0] prdata_o,
  output logic        pslverr_o,
  // ADC stream
  input  logic        sample_valid_i,
  input  logic [31:0] sample_u_i,
  input  logic [31:0] sample_v_i,
  input  logic        sample_clip_i,
  output logic        sample_ready_o,  // a sample of this interval will be latched
  output logic        irq_o,
  output logic        idle_o           // nothing changes at the coming edge of itself
);

  localparam int TickClocks = Paper != 0 ? 32 * IterationClocks : 32;

  // Commands of the register bank
  logic        clear, adc_enable, soft_valid, load_command;
  logic [31:0] soft_u;

  // Sequencer
  logic    place_free, stream_early, soft_early, busy, busy_next;
  tick_t   tick;
  sample_t stream, held;

  // Settings and state; updates and results of the datapath
  settings_t   settings;
  correction_t correction;
  state_t      state, state_next;
  state_we_t   state_we;
  logic        frozen, commit, pending, distrust, bad_parity, bad_safety;
  flags_t      flags_next;
  status_t     status;
  logic [31:0] turn_flags, result;
  logic [3:0]  result_select;

  assign sample_ready_o = adc_enable & place_free;
  assign idle_o         = ~busy;
  assign stream.u       = sample_u_i;
  assign stream.v       = sample_v_i;
  assign stream.clip    = sample_clip_i;

  sequencer #(
    .TickClocks (TickClocks)
  ) u_sequencer (
    .clk_i          (pclk_i),
    .rst_ni         (presetn_i),
    .clear_i        (clear),
    .stream_valid_i (sample_valid_i & adc_enable),
    .stream_i       (stream),
    .soft_valid_i   (soft_valid),
    .soft_u_i       (soft_u),
    .soft_v_i       (pwdata_i),
    .load_i         (load_command),
    .place_free_o   (place_free),
    .stream_early_o (stream_early),
    .soft_early_o   (soft_early),
    .busy_o         (busy),
    .busy_next_o    (busy_next),
    .tick_o         (tick),
    .held_o         (held)
  );

  datapath #(
    .Paper           (Paper),
    .OperandBits     (OperandBits),
    .ReferenceLead   (ReferenceLead),
    .StepShift       (StepShift),
    .PlainArctangent (PlainArctangent),
    .IterationClocks (IterationClocks),
    .Block           (Block),
    .Harmonics       (Harmonics),
    .Safety          (Safety)
  ) u_datapath (
    .clk_i           (pclk_i),
    .rst_ni          (presetn_i),
    .clear_i         (clear),
    .tick_i          (tick),
    .held_i          (held),
    .settings_i      (settings),
    .correction_i    (correction),
    .frozen_i        (frozen),
    .pending_i       (pending),
    .distrust_i      (distrust),
    .bad_parity_i    (bad_parity),
    .bad_safety_i    (bad_safety),
    .state_i         (state),
    .state_we_o      (state_we),
    .state_o         (state_next),
    .commit_o        (commit),
    .flags_o         (flags_next),
    .status_o        (status),
    .turn_flags_o    (turn_flags),
    .result_select_i (result_select),
    .result_o        (result)
  );

  register_bank #(
    .Paper (Paper),
    .TickClocks (TickClocks),
    .Block (Block),
    .Harmonics (Harmonics),
    .Safety (Safety)
  ) u_register_bank (
    .clk_i           (pclk_i),
    .rst_ni          (presetn_i),
    .psel_i, .penable_i, .pwrite_i, .paddr_i, .pwdata_i, .pstrb_i, .pready_o, .prdata_o, .pslverr_o, .irq_o,
    .clear_o         (clear),
    .adc_enable_o    (adc_enable),
    .soft_valid_o    (soft_valid),
    .soft_u_o        (soft_u),
    .load_o          (load_command),
    .busy_i          (busy),
    .busy_next_i     (busy_next),
    .stream_early_i  (stream_early),
    .soft_early_i    (soft_early),
    .settings_o      (settings),
    .correction_o    (correction),
    .frozen_o        (frozen),
    .pending_o       (pending),
    .distrust_o      (distrust),
    .bad_parity_o    (bad_parity),
    .bad_safety_o    (bad_safety),
    .state_o         (state),
    .boundary_i      (tick.boundary),
    .state_we_i      (state_we),
    .state_i         (state_next),
    .commit_i        (commit),
    .flags_i         (flags_next),
    .status_i        (status),
    .turn_flags_i    (turn_flags),
    .result_select_o (result_select),
    .result_i        (result)
  );

endmodule
