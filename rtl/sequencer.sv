// SPDX-License-Identifier: Apache-2.0
// Sequencer and holding register: which stage of the pipeline holds a sample, and when ticks begin
// and end. docs/reference/coprocessor.md, "Sequencer: time".
//
// Latency: a sample that an idle sequencer latches at edge c enters T0 at edge c + 1 and leaves T4
// five ticks later: at edge c + 161 with TickClocks = 32, at c + 321 with 64.
// A unit counts 32 cycles in every tick. In a tick of 64 clocks cycle 30 is followed by 32 clocks of rest, in which the cycle stays and
// only the paper's arctangents work; cycle 31 is the last clock in both.
// Formats: a sample's words Q1.31, never computed with. The tick's boundary is the edge that ends
// an interval with tick_o.boundary = 1.
module sequencer #(
  parameter int TickClocks = 32, // or 64
  parameter int Channels = 1
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        clear_i,         // soft reset: wins over everything of its edge
  // Samples; the two sources may come at one edge, the stream is then first.
  input  logic        stream_valid_i,  // from the ADC, CTRL.ADC set
  input  sample_t     stream_i,
  input  logic        soft_valid_i,    // from software
  input  logic [31:0] soft_u_i,
  input  logic [31:0] soft_v_i,
  input  logic        load_i,          // CMD.LOAD
  output logic        place_free_o,    // the holding register can take a sample at this edge
  output logic        stream_early_o,  // a sample of this edge is lost
  output logic        soft_early_o,
  // Of several channels
  input  logic        blocked_i,         // the held sample may not enter
  input  logic        held_foreign_i,    // it is not of the active channel: it is no business of the pipeline's, and a soft reset leaves it
  input  logic        stream_foreign_i,  // nor is the one of the stream
  output logic        stream_latch_o,    // the holding register takes a sample at this edge
  output logic        soft_latch_o,
  output logic        running_o,         // a tick is under way
  output logic        held_valid_o,
  output logic        load_pending_o,
  output logic        busy_o,
  output logic        busy_next_o,       // as this edge leaves it
  // To the datapath
  output tick_t       tick_o,
  output sample_t     held_o
);

  logic       held_q, held_d;
  logic       load_pending_q, load_pending_d;
  localparam int ClockBits = TickClocks == 64 ? 6 : 5;
  localparam logic [ClockBits-1:0] LastClock = ClockBits'(TickClocks - 1);
  logic [ClockBits-1:0] cycle_q, cycle_d;  // the clock of the tick
  logic [4:0] stage_q, stage_d;
  logic [2:0] load_q, load_d;

  // A tick runs if something is in it. There is no other state of being busy: whatever could wait
  // when a tick ends empty enters at that boundary.
  logic       running, boundary, enter, blocked, held_own;
  logic [2:0] load_start;
  assign running    = (|stage_q) | (|load_q);
  assign blocked   = Channels > 1 & blocked_i;
  assign held_own  = held_q & ~(Channels > 1 & held_foreign_i);
  assign boundary  = running ? cycle_q == LastClock : (held_q & ~blocked) | load_pending_q;

  // A load begins when no sample is left in the pipeline, and no sample passes a load that waits.
  logic load_goes_on, load_begins;
  assign load_goes_on = |load_q[1:0];
  assign load_begins  = boundary & load_pending_q & ~load_goes_on & ~(|stage_q[3:0]);
  assign enter        = boundary & held_q & ~load_pending_q & ~load_goes_on & ~blocked;
  assign load_start   = {load_q[1], load_q[0], load_begins} & {3{boundary}};

  logic stream_latch, soft_latch, latch;
  assign place_free_o   = ~held_q | enter;
  assign stream_latch   = stream_valid_i & place_free_o;
  assign stream_early_o = stream_valid_i & ~place_free_o;
  assign soft_latch     = soft_valid_i & place_free_o & ~stream_valid_i;
  assign soft_early_o   = soft_valid_i & ~soft_latch;
  assign latch          = stream_latch | soft_latch;

  logic foreign_d;
  assign foreign_d = Channels > 1 & (latch ? stream_latch & stream_foreign_i : held_foreign_i);
  assign stream_latch_o = stream_latch;
  assign soft_latch_o   = soft_latch;
  assign running_o      = running;
  assign held_valid_o   = held_q;
  assign load_pending_o = load_pending_q;

  always_comb begin
    held_d         = latch | (held_q & ~enter);
    load_pending_d = load_i | (load_pending_q & ~load_begins);
    cycle_d        = running ? cycle_q + ClockBits'(1) : '0;
    stage_d        = boundary ? {stage_q[3:0], enter} : stage_q;
    load_d         = boundary ? load_start : load_q;
    if (clear_i) begin
      held_d         = 1'b0;
      if (foreign_d) held_d = latch | ~place_free_o;
      load_pending_d = 1'b0;
      cycle_d        = '0;
      stage_d        = '0;
      load_d         = '0;
    end
  end

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      held_q         <= 1'b0;
      load_pending_q <= 1'b0;
      cycle_q        <= '0;
      stage_q        <= '0;
      load_q         <= '0;
    end else begin
      held_q         <= held_d;
      load_pending_q <= load_pending_d;
      cycle_q        <= cycle_d;
      stage_q        <= stage_d;
      load_q         <= load_d;
    end
  end

`ifdef VERILATOR
  always_ff @(posedge clk_i) begin
    if (rst_ni) begin
      assert ($onehot0(load_q)) else $error("two steps of a LOAD in one tick: %b", load_q);
      assert (~(|load_q) | ~(|stage_q)) else $error("a LOAD and a sample in one tick: %b, %b", load_q, stage_q);
      assert (running | cycle_q == '0) else $error("cycle %0d without a tick", cycle_q);
    end
  end
`endif

  // Data of the held sample. They are not used while held_q is 0, so a soft reset keeps them.
  logic [31:0] held_u_d, held_v_d, held_u_q, held_v_q;
  logic        held_clip_d, held_clip_q;
  assign held_u_d    = stream_valid_i ? stream_i.u : soft_u_i;
  assign held_v_d    = stream_valid_i ? stream_i.v : soft_v_i;
  assign held_clip_d = stream_valid_i & stream_i.clip;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      held_u_q    <= '0;
      held_v_q    <= '0;
      held_clip_q <= 1'b0;
    end else if (latch) begin
      held_u_q    <= held_u_d;
      held_v_q    <= held_v_d;
      held_clip_q <= held_clip_d;
    end
  end

  assign busy_next_o = (held_d & ~foreign_d) | load_pending_d | (|stage_d) | (|load_d);
  assign busy_o = running | held_own | load_pending_q;
  assign tick_o.boundary   = boundary;
  assign tick_o.enter      = enter;
  assign tick_o.clock      = 6'(cycle_q);
  if (TickClocks == 64) begin : g_rest
    logic late;
    assign late = cycle_q > 6'd30;
    assign tick_o.rest  = late && cycle_q != LastClock;
    assign tick_o.cycle = {late ? 4'd15 : cycle_q[4:1], late ? cycle_q == LastClock : cycle_q[0]};
  end else begin : g_no_rest
    assign tick_o.rest  = 1'b0;
    assign tick_o.cycle = cycle_q;
  end
  assign tick_o.stage      = stage_q;
  assign tick_o.load       = load_q;
  assign tick_o.load_start = load_start;
  assign held_o.u    = held_u_q;
  assign held_o.v    = held_v_q;
  assign held_o.clip = held_clip_q;

endmodule
