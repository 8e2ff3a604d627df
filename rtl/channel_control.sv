// SPDX-License-Identifier: Apache-2.0
// Channels (docs/reference/coprocessor.md): whose context is in the registers, its change, CHANNEL, and what has to be known
// of a channel whose context is elsewhere. Not there with one channel.
//
// A change takes 32 clocks after the edge at which it begins. In clock i the units' memories exchange word i of their contexts and the chain
// of flip-flops moves by its word i. Word i of the new context was read in the clock before. With the last word the registers are cleared
// if the channel has had no context since the reset. In clock 0 the registers are as the old channel has left them, and its interrupt,
// CTRL.ADC and CTRL.IE_ERROR are noted at the end of it.
module channel_control #(
  parameter int Channels = 2  // to 16
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  // Bus
  input  logic        write_i,           // of CHANNEL
  input  logic [31:0] pwdata_i,
  input  logic        refused_i,         // an access of a register that the window does not show
  output logic [31:0] word_o,            // CHANNEL
  output logic        ready_o,
  // Sequencer
  input  logic        running_i,         // a tick is under way
  input  logic        load_pending_i,
  input  logic        held_i,
  input  logic        stream_latch_i,    // at this edge the holding register takes a sample of the stream, of software
  input  logic        soft_latch_i,
  output logic        blocked_o,         // the held sample may not enter T0
  output logic        held_foreign_o,    // it is not the active channel's
  output logic        stream_foreign_o,  // nor is the one of the stream
  output logic        busy_o,            // a change is under way or about to begin
  // Samples
  input  logic [3:0]  sample_channel_i,
  input  logic        stream_early_i,    // the stream's sample is lost
  output logic        sample_adc_o,      // CTRL.ADC of its channel
  output logic        own_early_o,       // the lost sample is the active channel's: its registers count it
  // The active channel's registers
  input  logic        adc_i,
  input  logic        ie_error_i,
  input  logic        irq_i,             // with early_flag_o
  input  logic        clear_flag_i,      // FLAGS.EARLY and
  input  logic        clear_count_i,     // EARLY_COUNT are cleared
  output logic        early_flag_o,      // samples were lost while another channel was active
  output logic [31:0] early_count_o,     // how many
  output logic        irq_o,
  // Contexts
  output change_t     change_o,
  input  context_t    context_i,         // word change_o.index of the old one
  output context_t    context_o          // of the new one
);

  localparam logic [3:0] Last = 4'(Channels - 1);
  localparam int Bits = $clog2(Channels);
  localparam logic [4:0] Count = 5'(Channels);

  // CHANNEL and the channel of the held sample
  logic [3:0] window_q, active_q, target_q, held_channel_q;
  logic       hold_q, refused_q, changing_q, has_window;
  logic [4:0] index_q;
  capsoc_coprocessor_channel_t written;
  assign written = pwdata_i;
  assign has_window = {1'b0, written.WINDOW} < Count;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      window_q <= '0;
      hold_q <= 1'b1;
      refused_q <= 1'b0;
    end else begin
      if (write_i && has_window) begin
        window_q <= written.WINDOW;
        hold_q <= written.HOLD;
      end
      if (refused_i || write_i) refused_q <= refused_i || !has_window || (refused_q && !written.REFUSED);
    end
  end
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) held_channel_q <= '0;
    else if (stream_latch_i) held_channel_q <= sample_channel_i;
    else if (soft_latch_i) held_channel_q <= active_q;
  end

  // What waits for what
  logic waits_for_window, wanted, begins, ends;
  assign waits_for_window = hold_q && window_q != active_q;
  assign held_foreign_o = held_channel_q != active_q;
  assign stream_foreign_o = sample_channel_i != active_q;
  assign wanted = hold_q ? waits_for_window : held_i && held_foreign_o;
  assign begins = wanted && !changing_q && !running_i && !load_pending_i;
  assign ends = changing_q && index_q == 5'd31;
  assign blocked_o = held_foreign_o || waits_for_window || changing_q;
  assign ready_o = hold_q && !waits_for_window && !changing_q;
  assign busy_o = changing_q || wanted;

  logic [3:0] target;
  assign target = changing_q ? target_q : waits_for_window ? window_q : held_channel_q;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      active_q <= '0;
      target_q <= '0;
      changing_q <= 1'b0;
      index_q <= '0;
    end else begin
      if (begins) target_q <= target;
      if (begins || ends) changing_q <= begins;
      if (ends) active_q <= target_q;
      if (changing_q) index_q <= index_q + 5'd1;  // to 0 with the last
    end
  end

  // Contexts. Words of one that was never written are read as 0.
  context_t context_read;
  logic [Channels-1:0] known_q, active_bit, target_bit, sample_bit;  // the last is 0 of a channel that is not there
  logic known;
  assign active_bit = Channels'(1) << active_q;
  assign target_bit = Channels'(1) << target_q;
  assign sample_bit = Channels'(1) << sample_channel_i;
  assign known = |(known_q & target_bit);
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) known_q <= Channels'(1);
    else if (ends) known_q <= known_q | target_bit;
  end
  context_memory #(
    .Channels (Channels)
  ) u_context_memory (
    .clk_i,
    .read_i          (begins || changing_q),
    .read_channel_i  (target),
    .read_index_i    (index_q + 5'(changing_q)),
    .context_o       (context_read),
    .write_i         (changing_q),
    .write_channel_i (active_q),
    .write_index_i   (index_q),
    .context_i       (context_i)
  );
  assign context_o = known ? context_read : '0;
  assign change_o.shift = changing_q;
  assign change_o.clear = ends && !known;
  assign change_o.index = index_q;
  assign change_o.channel = active_q;

  // Of channels whose registers are away
  logic moved, lost_away;
  logic [Channels-1:0] adc_q, ie_error_q, irq_q, early_q, counted_q, pending;
  assign moved = changing_q && index_q != '0;
  assign own_early_o = !stream_foreign_o && !changing_q;
  assign lost_away = stream_early_i && !own_early_o;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      {adc_q, ie_error_q, irq_q} <= '0;
    end else if (changing_q && !moved) begin
      adc_q <= (adc_q & ~active_bit) | (active_bit & {Channels{adc_i}});
      ie_error_q <= (ie_error_q & ~active_bit) | (active_bit & {Channels{ie_error_i}});
      irq_q <= (irq_q & ~active_bit) | (active_bit & {Channels{irq_i}});
    end
  end
  assign sample_adc_o = |(sample_bit & (stream_foreign_o || moved ? adc_q : {Channels{adc_i}}));

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      {early_q, counted_q} <= '0;
    end else begin
      early_q <= (early_q & ~(active_bit & {Channels{clear_flag_i}})) | (sample_bit & {Channels{lost_away}});
      counted_q <= (counted_q & ~(active_bit & {Channels{clear_count_i}})) | (sample_bit & {Channels{lost_away}});
    end
  end
  logic [31:0] counts[0:Channels-1];
  logic [31:0] count;
  assign count = counts[sample_channel_i[Bits-1:0]] & {32{|(counted_q & sample_bit)}};
  always_ff @(posedge clk_i) begin
    if (lost_away) counts[sample_channel_i[Bits-1:0]] <= count + 32'(!(&count));
  end
  assign early_flag_o = |(early_q & active_bit) && !moved;
  assign early_count_o = counts[active_q[Bits-1:0]] & {32{|(counted_q & active_bit)}};

  // The active channel's interrupt, with its flag of samples that were lost meanwhile, is that of the registers.
  assign pending = moved ? irq_q | (early_q & ie_error_q)
                         : ((irq_q | (early_q & ie_error_q)) & ~active_bit) | (active_bit & {Channels{irq_i}});
  assign irq_o = |pending;

  capsoc_coprocessor_channel_t shown;
  assign shown.PENDING = 16'(pending);
  assign shown.LAST = Last;
  assign shown.RESERVED_11 = 1'b0;
  assign shown.REFUSED = refused_q;
  assign shown.READY = ready_o;
  assign shown.HOLD = hold_q;
  assign shown.RESERVED_7_4 = '0;
  assign shown.WINDOW = window_q;
  assign word_o = shown;

  logic unused_bits;
  assign unused_bits = ^{written.PENDING, written.LAST, written.RESERVED_11, written.READY, written.RESERVED_7_4};

`ifdef VERILATOR
  always_ff @(posedge clk_i) begin
    if (rst_ni) begin
      assert (!changing_q || (!running_i && !load_pending_i)) else $error("a context changes while its pipeline works");
      assert (!begins || target != active_q) else $error("a change to the channel that is active");
      assert ({1'b0, active_q} < Count && {1'b0, target_q} < Count && {1'b0, window_q} < Count) else $error("there is no such channel");
    end
  end
`endif

endmodule
