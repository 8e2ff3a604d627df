// SPDX-License-Identifier: Apache-2.0
// Changes of context (channel_control.sv): when they begin, that they take 32 clocks, and that a channel gets back what it has left.
// Watched is any word of any channel; of a channel that never had a context the units are cleared instead.
module channel_control_properties #(
  parameter int Channels = 3
) (
  input logic        clk_i,
  input logic        write_i, refused_i,
  input logic [31:0] pwdata_i,
  input logic        running_i, load_pending_i, held_i, stream_latch_i, soft_latch_i,
  input logic [3:0]  sample_channel_i,
  input logic        stream_early_i, adc_i, ie_error_i, irq_i, clear_flag_i, clear_count_i,
  input context_t    context_i
);

  logic in_reset = 1'b1;
  always @(posedge clk_i) in_reset <= 1'b0;

  logic [31:0] word, early_count;
  logic        ready, blocked, held_foreign, stream_foreign, busy, sample_adc, own_early, early_flag, irq;
  change_t     change;
  context_t    context_out;
  channel_control #(.Channels(Channels)) dut (
    .clk_i, .rst_ni (~in_reset), .write_i, .pwdata_i, .refused_i, .word_o (word), .ready_o (ready),
    .running_i, .load_pending_i, .held_i, .stream_latch_i, .soft_latch_i,
    .blocked_o (blocked), .held_foreign_o (held_foreign), .stream_foreign_o (stream_foreign), .busy_o (busy),
    .sample_channel_i, .stream_early_i, .sample_adc_o (sample_adc), .own_early_o (own_early),
    .adc_i, .ie_error_i, .irq_i, .clear_flag_i, .clear_count_i, .early_flag_o (early_flag), .early_count_o (early_count),
    .irq_o (irq), .change_o (change), .context_i, .context_o (context_out)
  );
  (* hierconn *) logic [3:0] \dut.active_q ;
  (* hierconn *) logic [3:0] \dut.target_q ;
  (* hierconn *) logic [3:0] \dut.window_q ;
  (* hierconn *) logic [3:0] \dut.held_channel_q ;
  (* hierconn *) logic       \dut.hold_q ;
  (* hierconn *) logic [4:0] \dut.index_q ;
  (* hierconn *) logic [Channels-1:0] \dut.known_q ;
  (* hierconn *) logic [6:0] \dut.u_context_memory.probe ;
  (* hierconn *) logic [168:0] \dut.u_context_memory.probed ;
  (* hierconn *) logic [168:0] \dut.u_context_memory.context_q ;
  logic [3:0] active, target, window, held_channel;
  assign active = \dut.active_q ;
  assign target = \dut.target_q ;
  assign window = \dut.window_q ;
  assign held_channel = \dut.held_channel_q ;

  // The sequencer: no tick begins in a change, and a LOAD is asked for through the window alone. Only samples of channels that are there
  // are taken.
  always @* assume (!change.shift || (!running_i && !load_pending_i));
  always @* assume (!stream_latch_i || sample_channel_i < 4'(Channels));

  // When a change begins, what it leads to, and 32 clocks.
  logic       was_shift, was_wanted;
  logic [3:0] was_active, was_target, was_aim;
  logic [5:0] clocks;  // of the change under way
  always @(posedge clk_i) begin
    was_shift  <= change.shift & ~in_reset;
    was_active <= active;
    was_target <= target;
    was_wanted <= ~in_reset & ~running_i & ~load_pending_i & ~change.shift &
                  (\dut.hold_q ? window != active : held_i & held_channel != active);
    was_aim    <= \dut.hold_q ? window : held_channel;
    if (in_reset | ~change.shift) clocks <= '0;
    else clocks <= clocks == 6'd31 ? '0 : clocks + 6'd1;
  end
  always @* if (~in_reset) begin
    assert (active < 4'(Channels) && target < 4'(Channels) && window < 4'(Channels) && held_channel < 4'(Channels));
    assert ({1'b0, \dut.index_q } == clocks && clocks < 6'd32);
    if (~was_shift) assert (change.shift == was_wanted);
    if (~was_shift && change.shift) assert (target == was_aim && clocks == '0 && active == was_active);
    if (was_shift && change.shift) assert (target == was_target && active == was_active);
    if (was_shift && ~change.shift) assert (active == was_target && clocks == '0);
    if (was_shift && clocks == '0) assert (~change.shift);
    if (change.shift) assert (target != active && ~ready && blocked);
    if (ready) assert (window == active);
    assert (|(\dut.known_q & (Channels'(1) << active)));
  end

  // The watched word, as the channel has left it.
  logic [6:0] watched;
  logic       seen = 1'b0;
  context_t   left;
  assign watched = \dut.u_context_memory.probe ;
  always @* assume ({1'b0, watched[6:5]} < 3'(Channels));
  always @(posedge clk_i) begin
    if (in_reset) seen <= 1'b0;
    else if (change.shift && {active[1:0], \dut.index_q } == watched) begin
      seen <= 1'b1;
      left <= context_i;
    end
  end
  logic returns;
  assign returns = change.shift && {target[1:0], \dut.index_q } == watched;
  always @* if (~in_reset) begin
    if (seen) assert (\dut.u_context_memory.probed == left);
    if (returns) assert (\dut.u_context_memory.context_q == \dut.u_context_memory.probed );
    if (returns && seen && |(\dut.known_q & (Channels'(1) << target))) assert (context_out == left);
    if (returns && ~|(\dut.known_q & (Channels'(1) << target))) assert (context_out == '0);
    if (change.clear) assert (clocks == 6'd31 && ~|(\dut.known_q & (Channels'(1) << target)));
    if (change.shift && clocks == 6'd31) assert (change.clear == ~|(\dut.known_q & (Channels'(1) << target)));
  end

endmodule
