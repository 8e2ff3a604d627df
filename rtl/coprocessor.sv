// SPDX-License-Identifier: Apache-2.0
// Self-calibration coprocessor (docs/reference/coprocessor.md): an APB slave with a sample port.
//
// Latency: a sample is committed 161 cycles after the edge that latches it, up to 31 more if it has
// to wait for a tick boundary. In `paper` with IterationClocks = 2 it is 321, and up to 63 more. APB: no wait states.
// Formats: sample words Q1.31, two's complement; registers as documented.
// With several channels a sample of another one than the active channel is committed 33 cycles later.
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
  parameter int Safety        = 1,   // safety mechanisms, SAFETY and parity bits
  parameter int Channels      = 1    // sensors that share the pipeline, 1..16
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
  input  logic [3:0]  sample_channel_i,  // with several channels: whose it is
  output logic        sample_ready_o,  // a sample of this interval will be latched
  output logic        irq_o,
  output logic        idle_o           // nothing changes at the coming edge of itself
);

  localparam int TickClocks = Paper != 0 ? 32 * IterationClocks : 32;

  // Commands of the register bank
  logic        clear, soft_reset, adc_enable, soft_valid, load_command;
  logic [31:0] soft_u;

  // Sequencer
  logic    place_free, stream_valid, stream_early, soft_early, busy, busy_next;
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

  // Several channels, and what takes their place with one
  logic    blocked, held_foreign, stream_foreign, stream_latch, soft_latch, running, held_valid, load_pending;
  logic    sample_adc, own_early, ready, refused, channel_write, ie_error, clear_early, clear_count, early_flag, own_irq;
  logic [31:0] channel_word, early_count;
  change_t  change;
  context_t context_old, context_new;
  chain_t   chain_bank, chain_datapath;
  logic [31:0] old_words, old_sample, old_error, old_quality;
  assign stream_valid = sample_valid_i & sample_adc;

  assign sample_ready_o = sample_adc & place_free;
  assign stream.u       = sample_u_i;
  assign stream.v       = sample_v_i;
  assign stream.clip    = sample_clip_i;

  sequencer #(
    .TickClocks (TickClocks),
    .Channels   (Channels)
  ) u_sequencer (
    .clk_i          (pclk_i),
    .rst_ni         (presetn_i),
    .clear_i        (soft_reset),
    .stream_valid_i (stream_valid),
    .stream_i       (stream),
    .soft_valid_i   (soft_valid),
    .soft_u_i       (soft_u),
    .soft_v_i       (pwdata_i),
    .load_i         (load_command),
    .place_free_o   (place_free),
    .stream_early_o (stream_early),
    .soft_early_o   (soft_early),
    .blocked_i        (blocked),
    .held_foreign_i   (held_foreign),
    .stream_foreign_i (stream_foreign),
    .stream_latch_o   (stream_latch),
    .soft_latch_o     (soft_latch),
    .running_o        (running),
    .held_valid_o     (held_valid),
    .load_pending_o   (load_pending),
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
    .Safety          (Safety),
    .Channels        (Channels)
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
    .result_o        (result),
    .change_i        (change),
    .chain_i         (chain_bank),
    .chain_o         (chain_datapath),
    .context_sample_i  (context_new.sample),
    .context_error_i   (context_new.error),
    .context_quality_i (context_new.quality),
    .context_sample_o  (old_sample),
    .context_error_o   (old_error),
    .context_quality_o (old_quality)
  );

  register_bank #(
    .Paper (Paper),
    .TickClocks (TickClocks),
    .Block (Block),
    .Harmonics (Harmonics),
    .Safety (Safety),
    .Channels (Channels)
  ) u_register_bank (
    .clk_i           (pclk_i),
    .rst_ni          (presetn_i),
    .psel_i, .penable_i, .pwrite_i, .paddr_i, .pwdata_i, .pstrb_i, .pready_o, .prdata_o, .pslverr_o,
    .irq_o           (own_irq),
    .clear_o         (clear),
    .soft_reset_o    (soft_reset),
    .adc_enable_o    (adc_enable),
    .soft_valid_o    (soft_valid),
    .soft_u_o        (soft_u),
    .load_o          (load_command),
    .busy_i          (busy),
    .busy_next_i     (busy_next),
    .stream_early_i  (stream_early & own_early),
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
    .result_i        (result),
    .ready_i         (ready),
    .refused_o       (refused),
    .channel_write_o (channel_write),
    .channel_i       (channel_word),
    .ie_error_o      (ie_error),
    .clear_early_o   (clear_early),
    .clear_count_o   (clear_count),
    .early_flag_i    (early_flag),
    .early_count_i   (early_count),
    .change_i        (change),
    .context_i       (context_new.words),
    .context_o       (old_words),
    .chain_i         (context_new.chain),
    .chain_o         (chain_bank)
  );

  if (Channels > 1) begin : g_channels
    logic changes;
    channel_control #(
      .Channels (Channels)
    ) u_channel_control (
      .clk_i            (pclk_i),
      .rst_ni           (presetn_i),
      .write_i          (channel_write),
      .pwdata_i,
      .refused_i        (refused),
      .word_o           (channel_word),
      .ready_o          (ready),
      .running_i        (running),
      .load_pending_i   (load_pending),
      .held_i           (held_valid),
      .stream_latch_i   (stream_latch),
      .soft_latch_i     (soft_latch),
      .blocked_o        (blocked),
      .held_foreign_o   (held_foreign),
      .stream_foreign_o (stream_foreign),
      .busy_o           (changes),
      .sample_channel_i,
      .stream_early_i   (stream_early),
      .sample_adc_o     (sample_adc),
      .own_early_o      (own_early),
      .adc_i            (adc_enable),
      .ie_error_i       (ie_error),
      .irq_i            (own_irq),
      .clear_flag_i     (clear_early),
      .clear_count_i    (clear_count),
      .early_flag_o     (early_flag),
      .early_count_o    (early_count),
      .irq_o,
      .change_o         (change),
      .context_i        (context_old),
      .context_o        (context_new)
    );
    assign idle_o = ~(busy | held_valid | changes);

    // The last word of the chain is filled up.
    localparam int Kept = 1285;            // flip-flops of the units' contexts
    localparam int Rest = 32 * 41 - Kept;  // chain_t has 41 bits
    logic [Rest-1:0] rest_q, rest_moved;
    chain_t chain_rest;
    context_chain #(.Channels(Channels), .Width(Rest)) u_rest (
      .kept_i(rest_q), .chain_i(chain_datapath), .moved_o(rest_moved), .chain_o(chain_rest)
    );
    always_ff @(posedge pclk_i or negedge presetn_i) begin
      if (!presetn_i) rest_q <= '0;
      else if (change.shift) rest_q <= rest_moved;
    end
    assign context_old = {chain_rest, old_words, old_sample, old_error, old_quality};
  end else begin : g_one_channel
    assign {blocked, held_foreign, stream_foreign, early_flag} = '0;
    assign {sample_adc, own_early, ready} = {adc_enable, 2'b11};
    assign {channel_word, early_count} = '0;
    assign {change, context_old, context_new} = '0;
    assign irq_o = own_irq;
    assign idle_o = ~busy;
    logic unused_channels;
    assign unused_channels = ^{sample_channel_i, stream_latch, soft_latch, running, held_valid, load_pending, refused, channel_write,
                               ie_error, clear_early, clear_count, context_old, chain_datapath,
                               old_words, old_sample, old_error, old_quality};
  end

endmodule
