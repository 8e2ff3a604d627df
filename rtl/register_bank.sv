// SPDX-License-Identifier: Apache-2.0
// Register bank: the APB slave and every register that is not a result (docs/reference/coprocessor.md,
// "Registers").
//
// Latency: a write counts from the edge that ends its access phase; prdata_o is combinational and
// shows the state after the last edge. No wait states, and nothing depends on the setup phase.
// Formats: phase, freq 2^-48 turn; au .. cv s48, Q2.46; a1, a2, b1, b2 Q1.31; beta, phi 2^-32 turn;
// steps u31 and thresholds u32, Q1.31.
module register_bank #(
  parameter int Paper = 0,
  parameter int TickClocks = 32,
  parameter int Block = 1,
  parameter int Harmonics = 1,
  parameter int Safety = 1,
  parameter int Channels = 1
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  // APB
  input  logic        psel_i,
  input  logic        penable_i,
  input  logic        pwrite_i,
  input  logic [11:0] paddr_i,
  input  logic [31:0] pwdata_i,
  input  logic [3:0]  pstrb_i,
  output logic        pready_o,
  output logic [31:0] prdata_o,
  output logic        pslverr_o,
  output logic        irq_o,
  // Sequencer
  output logic        clear_o,       // CTRL.SRST, or a context begins as after a reset
  output logic        soft_reset_o,  // CTRL.SRST
  output logic        adc_enable_o,
  output logic        soft_valid_o,  // SOFT_V is written: (soft_u_o, pwdata_i) is a sample
  output logic [31:0] soft_u_o,
  output logic        load_o,        // CMD.LOAD
  input  logic        busy_i,
  input  logic        busy_next_i,   // as this edge leaves it
  input  logic        stream_early_i,
  input  logic        soft_early_i,
  // Settings
  output settings_t   settings_o,
  output correction_t correction_o,
  output logic        frozen_o,      // with what this edge commits
  output logic        pending_o,     // FLAGS.RESULT
  output logic        distrust_o,    // one of the safety mechanisms' flags
  output logic        bad_parity_o,  // with boundary_i: a register does not fit its parity bit
  output logic        bad_safety_o,  // likewise: SAFETY does not
  // State, and what the pipeline writes at a tick's boundary
  output state_t      state_o,
  input  logic        boundary_i,
  input  state_we_t   state_we_i,
  input  state_t      state_i,
  // Results
  input  logic        commit_i,
  input  flags_t      flags_i,
  input  status_t     status_i,
  input  logic [31:0] turn_flags_i,
  output logic [3:0]  result_select_o,
  input  logic [31:0] result_i,
  // Channels
  input  logic        ready_i,         // the window shows the registers
  output logic        refused_o,       // an access of one that it does not show
  output logic        channel_write_o,
  input  logic [31:0] channel_i,       // CHANNEL
  output logic        ie_error_o,
  output logic        clear_early_o,   // FLAGS.EARLY, EARLY_COUNT are cleared
  output logic        clear_count_o,
  input  logic        early_flag_i,    // more of both
  input  logic [31:0] early_count_i,
  input  change_t     change_i,
  input  logic [31:0] context_i,       // word change_i.index of the memory in a change: the new one, the old one
  output logic [31:0] context_o,
  input  chain_t      chain_i,
  output chain_t      chain_o
);

  localparam logic [31:0] Latency = 32'(1 + 5 * TickClocks);  // five ticks after the one edge before them

  localparam logic [31:0] Version = capsoc_coprocessor_pkg::VERSION_RESET + 32'(Channels > 1);

  // Decoding. An error has no effect and reads 0. A select holds for mapped addresses, and so do the groups.
  capsoc_coprocessor_selects_t select;
  capsoc_coprocessor_groups_t  group;
  logic described, mapped, write, read, refused;
  logic [4:0] word_address;
  logic [31:0] readable, reset_word;
  capsoc_coprocessor_selects u_selects (
    .address_i    (paddr_i),
    .write_data_i (pwdata_i),
    .select_o     (select),
    .group_o      (group),
    .result_o     (result_select_o),
    .word_o       (word_address),
    .readable_o   (readable),
    .reset_o      (reset_word),
    .refused_o    (refused),
    .mapped_o     (described)
  );
  logic elsewhere;  // an access of CHANNEL, or of a register that the window does not show
  assign write     = psel_i & penable_i & pwrite_i & mapped & (&pstrb_i);
  assign read      = psel_i & penable_i & ~pwrite_i & mapped;
  assign pready_o  = 1'b1;
  assign pslverr_o = psel_i & penable_i & ~(write | read | elsewhere);

  // The window shows the registers of its channel, or only what all channels have. What it does not show is as if it were not mapped.
  logic channel_read;
  if (Channels > 1) begin : g_window
    logic access, is_channel, open;
    assign access          = psel_i & penable_i & (~pwrite_i | (&pstrb_i));
    assign is_channel      = paddr_i == capsoc_coprocessor_pkg::CHANNEL_OFFSET;
    assign open            = ready_i | select.ID | select.VERSION | select.LATENCY;
    assign mapped          = described & open;
    assign channel_write_o = access & is_channel & pwrite_i;
    assign channel_read    = access & is_channel & ~pwrite_i;
    assign refused_o       = access & described & ~open;
    assign elsewhere       = (access & is_channel) | refused_o;
  end else begin : g_no_window
    assign mapped = described;
    assign {elsewhere, channel_write_o, channel_read, refused_o} = '0;
    logic unused_channel;
    assign unused_channel = ready_i ^ channel_read ^ (^channel_i);
  end

`ifdef VERILATOR
  always_ff @(posedge clk_i) begin
    if (rst_ni) assert (~(write | read) | $onehot(select)) else $error("access to 0x%h of several registers, or of none", paddr_i);
  end
`endif

  logic write_ctrl, write_cmd, clear_counters, zero_phase, soft_reset;
  assign write_ctrl     = write & select.CTRL;
  assign write_cmd      = write & select.CMD;
  assign soft_reset     = write_ctrl & pwdata_i[capsoc_coprocessor_pkg::CTRL_SRST_LSB];
  assign clear_o        = soft_reset | (Channels > 1 & change_i.clear);
  assign soft_reset_o   = soft_reset;
  assign load_o         = write_cmd & pwdata_i[capsoc_coprocessor_pkg::CMD_LOAD_LSB];
  assign clear_counters = write_cmd & pwdata_i[capsoc_coprocessor_pkg::CMD_CLEAR_LSB];
  assign zero_phase     = write_cmd & pwdata_i[capsoc_coprocessor_pkg::CMD_PHASE0_LSB];
  assign soft_valid_o   = write & select.SOFT_V;

  // The correction's nodes change between samples only.
  localparam int HasHarmonics = Paper == 0 && Harmonics != 0 ? 1 : 0;
  logic correction_refused;
  assign correction_refused = write & select.CORRECTION & (busy_next_i | HasHarmonics == 0);
  assign correction_o.write = write & select.CORRECTION & ~correction_refused;
  capsoc_coprocessor_correction_t correction;
  logic unused_correction;  // its reserved bits
  assign correction         = pwdata_i;
  assign correction_o.node  = correction.NODE;
  assign correction_o.value = correction.VALUE;
  assign unused_correction  = ^correction;

  logic safety_refused;
  assign safety_refused = write & select.SAFETY & Safety == 0;

  // Each pair has two words. LO's word stages a written low half; HI's word latches the low half at a read of HI. A
  // write of LO fills LO's word; a write of HI takes it and clears it to 0. A read of HI fills HI's word; a read of LO
  // takes it.
  logic        word_we, word_valid;
  logic [4:0]  word_source;
  logic [31:0] word_data, word_read, pair_high, pair_low;
  assign word_source  = word_address ^ {4'd0, group.pair};
  assign word_we      = (read & group.high) |
                        (write & group.stored & ~soft_valid_o & ~refused & ~safety_refused);
  chain_t chain_words, chain_settings, chain_state, chain_flags;
  word_memory #(
    .Used (capsoc_coprocessor_pkg::WORDS & ~(Safety != 0 ? 32'd0 : 32'd1 << capsoc_coprocessor_pkg::SAFETY_WORD)),
    .Channels (Channels)
  ) u_words (
    .clk_i, .rst_ni,
    .clear_i (clear_o),
    .we_i    (word_we),
    .waddr_i (word_address ^ {4'd0, pwrite_i & group.high}),
    .wdata_i (pwrite_i ? pwdata_i & {32{~group.high}} : pair_low),
    .raddr_i (word_source),
    .valid_o (word_valid),
    .rdata_o (word_read),
    .shift_i (change_i.shift), .index_i (change_i.index), .context_i, .chain_i, .chain_o (chain_words)
  );
  assign context_o = word_read;
  logic unused_change;
  assign unused_change = ^change_i;
  assign word_data = word_read & {32{word_valid}};
  assign soft_u_o  = word_data;

  // Registers
  logic      freeze, reserved_ref;
  enables_t  enables;
  settings_t settings;
  logic      settings_fault, state_fault;
  assign bad_parity_o = settings_fault | state_fault;
  setting_registers #(
    .Block (Paper == 0 && Block != 0 ? 1 : 0),
    .Harmonics (HasHarmonics),
    .Safety (Safety),
    .Channels (Channels)
  ) u_settings (
    .clk_i, .rst_ni,
    .clear_i       (clear_o),
    .write_i       (write & ~refused),
    .select_i      (select),
    .pwdata_i,
    .reserved_o    (reserved_ref),
    .freeze_o      (freeze),
    .enables_o     (enables),
    .adc_enable_o,
    .settings_o    (settings),
    .boundary_i,
    .fault_o       (settings_fault),
    .safety_fault_o(bad_safety_o),
    .shift_i (change_i.shift), .clear_context_i (change_i.clear), .chain_i (chain_words), .chain_o (chain_settings)
  );
  assign settings_o = settings;

  state_registers #(
    .Paper (Paper),
    .Safety (Safety),
    .Channels (Channels)
  ) u_state (
    .clk_i, .rst_ni,
    .clear_i       (clear_o),
    .write_i       (write & ~refused),
    .zero_phase_i  (zero_phase),
    .select_i      (select),
    .pwdata_i,
    .bad_parity_i  (settings.safety.BAD_PARITY),
    .staged_low_i  (word_data),
    .pair_high_o   (pair_high),
    .pair_low_o    (pair_low),
    .boundary_i, .state_we_i, .state_i, .state_o,
    .fault_o       (state_fault),
    .shift_i (change_i.shift), .chain_i (chain_settings), .chain_o (chain_state)
  );

  logic       commit;
  logic [15:0] events, flags;
  assign commit = commit_i & boundary_i;
  assign events = {flags_i.safety & {4{commit}},
                   {flags_i.unsettled, flags_i.alarm, flags_i.turn} & {3{commit}},
                   (write & refused) | reserved_ref | correction_refused | safety_refused,
                   {flags_i.mirrorchg, flags_i.diverged, flags_i.lockchg} & {3{commit}},
                   stream_early_i | soft_early_i,
                   {flags_i.zero, flags_i.sat, flags_i.clip} & {3{commit}}, commit};
  flag_register #(
    .Safety (Safety),
    .Channels (Channels)
  ) u_flags (
    .clk_i, .rst_ni,
    .clear_i      (clear_o),
    .set_i        (events),
    .write_i      (write & select.FLAGS),
    .write_data_i (pwdata_i[15:0]),
    .enables_i    (enables),
    .early_i      (early_flag_i),
    .flags_o      (flags),
    .irq_o,
    .shift_i (change_i.shift), .chain_i (chain_state), .chain_o (chain_flags)
  );
  assign ie_error_o    = enables.error;
  assign clear_early_o = soft_reset | (write & select.FLAGS & pwdata_i[capsoc_coprocessor_pkg::FLAGS_EARLY_LSB]);
  assign clear_count_o = soft_reset | clear_counters;

  localparam int ParityFlag = capsoc_coprocessor_pkg::FLAGS_PARITY_LSB;
  assign pending_o  = flags[capsoc_coprocessor_pkg::FLAGS_RESULT_LSB];
  assign distrust_o = |flags[ParityFlag+:4];
  localparam int AlarmFlag = capsoc_coprocessor_pkg::FLAGS_ALARM_LSB;
  assign frozen_o = freeze & (flags[AlarmFlag] | events[AlarmFlag]);

  logic [31:0] samples, early_count, early_here;
  sample_counters #(
    .Channels (Channels)
  ) u_counters (
    .clk_i, .rst_ni,
    .clear_i       (clear_o | clear_counters),
    .commit_i      (commit),
    .stream_early_i, .soft_early_i,
    .samples_o     (samples),
    .early_count_o (early_here),
    .shift_i (change_i.shift), .chain_i (chain_flags), .chain_o
  );
  // Samples that were lost while the channel was active, and others.
  if (Channels > 1) begin : g_early_count
    logic [32:0] early_sum;
    assign early_sum = {1'b0, early_here} + {1'b0, early_count_i};
    assign early_count = early_sum[31:0] | {32{early_sum[32]}};
  end else begin : g_early_here
    assign early_count = early_here;
    logic unused_count;
    assign unused_count = ^early_count_i;
  end

  // Reading: two levels of choices, the narrow words among them. A number's bits are the registers that have
  // them: a multiplexer by number takes less than one by selects, and one of three words (numbers 0 to 2) half
  // of one of four. What is not mapped has number 0 everywhere: the narrow words, of which none is selected.
  logic [1:0]  column, row, kind;
  logic [31:0] wide, narrow, stored;
  assign column    = {select.A2 | select.BETA | select.EARLY_COUNT, select.A1 | select.B2 | select.SAMPLES} & {2{mapped}};
  assign row       = {select.PHI | select.SAMPLES | select.EARLY_COUNT, select.B1 | select.B2 | select.BETA} & {2{mapped}};
  assign kind      = {group.result | (group.stored & ~group.high), group.result | group.high} & {2{mapped}};

  capsoc_coprocessor_ctrl_t ctrl;
  assign ctrl.SRST           = 1'b0;
  assign ctrl.RESERVED_30_15 = '0;
  assign ctrl.IE_SAFETY      = enables.safety;
  assign ctrl.CORRECT        = settings.correct;
  assign ctrl.IE_ALARM       = enables.alarm;
  assign ctrl.IE_TURN        = enables.turn;
  assign ctrl.IE_ERROR       = enables.error;
  assign ctrl.IE_LOCK        = enables.lock;
  assign ctrl.IE_RESULT      = enables.result;
  assign ctrl.GUARD          = settings.guard;
  assign ctrl.BLOCK          = settings.block;
  assign ctrl.FREEZE         = freeze;
  assign ctrl.ADC            = adc_enable_o;
  assign ctrl.REF            = settings.source;
  assign ctrl.CALIB          = settings.calib;
  assign ctrl.DEMOD          = settings.demod;

  capsoc_coprocessor_loop_t loop;
  assign loop.RESERVED_31_13 = '0;
  assign loop.KI             = settings.ki;
  assign loop.RESERVED_7_5   = '0;
  assign loop.KP             = settings.kp;

  capsoc_coprocessor_status_t status;
  assign status.RESERVED_31_14 = '0;
  assign status.GOOD_TURNS     = status_i.good_turns;
  assign status.RESERVED_11_9  = '0;
  assign status.ARITH          = Paper != 0;
  assign status.RESERVED_7_7   = 1'b0;
  assign status.FROZEN         = freeze & flags[AlarmFlag];
  assign status.ALARM          = status_i.alarm;
  assign status.VALID          = status_i.valid;
  assign status.MIRROR         = status_i.mirror;
  assign status.DIVERGED       = status_i.diverged;
  assign status.LOCK           = status_i.lock;
  assign status.BUSY           = busy_i;

  logic [31:0] a1, a2, b1, b2, beta, phi;
  assign {a1, a2, b1, b2, beta, phi} = state_o.parameters;
  always_comb begin
    case (row)
      2'd0:
        case (column)
          2'd0:    wide = narrow;
          2'd1:    wide = a1;
          default: wide = a2;
        endcase
      2'd1:
        case (column)
          2'd0:    wide = b1;
          2'd1:    wide = b2;
          default: wide = beta;
        endcase
      default:
        case (column)
          2'd0:    wide = phi;
          2'd1:    wide = samples;
          default: wide = early_count;
        endcase
    endcase
  end
  capsoc_coprocessor_selects_t shown;
  logic unused_shown;  // of the wide registers
  assign shown = select & {$bits(select){mapped}};
  assign unused_shown = ^shown;
  assign narrow = (capsoc_coprocessor_pkg::ID_RESET & {32{shown.ID}}) |
                  (Version & {32{shown.VERSION}}) |
                  (ctrl & {32{shown.CTRL}}) | (status & {32{shown.STATUS}}) |
                  ({16'd0, flags} & {32{shown.FLAGS}}) | (loop & {32{shown.LOOP}}) |
                  (Latency & {32{shown.LATENCY}}) |
                  (turn_flags_i & {32{shown.TURN_FLAGS}});

  // A setting that was never written reads its reset value.
  assign stored = word_valid ? word_data & readable : reset_word;

  logic [31:0] shown_word;
  always_comb begin
    case (kind)
      2'd0:    shown_word = wide;
      2'd1:    shown_word = pair_high;
      2'd2:    shown_word = stored;
      default: shown_word = result_i;
    endcase
  end
  if (Channels > 1) begin : g_prdata
    assign prdata_o = shown_word | (channel_i & {32{channel_read}});
  end else begin : g_prdata_of_one
    assign prdata_o = shown_word;
  end

endmodule
