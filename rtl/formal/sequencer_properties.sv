// SPDX-License-Identifier: Apache-2.0
// No sample is lost, doubled or overtaken, and the latency is 161 cycles, or 321 with ticks of 64 (sequencer.sv).
//
// Samples are numbered in the order in which they are latched. Counters of 4 bits are enough: the
// sequencer has room for six samples. The sample of number `watched` (any) is followed from its
// latch to its commit.
module sequencer_properties #(
  parameter int TickClocks = 32
) (
  input logic        clk_i,
  input logic        clear_i, stream_valid_i, soft_valid_i, load_i,
  input sample_t     stream_i,
  input logic [31:0] soft_u_i, soft_v_i
);

  logic in_reset = 1'b1;
  always @(posedge clk_i) in_reset <= 1'b0;

  logic        place_free, stream_early, soft_early, busy, boundary, enter, held_clip;
  localparam int Bits = TickClocks == 64 ? 6 : 5;
  logic        rest;
  logic [5:0]  clock;
  logic [4:0]  cycle, stage;
  logic [2:0]  load, load_start;
  logic [31:0] held_u, held_v;
  tick_t       tick;
  sample_t     sample;
  assign {boundary, enter, clock, cycle, rest, stage, load, load_start} = tick;
  assign {held_u, held_v, held_clip} = sample;
  sequencer #(
    .TickClocks (TickClocks)
  ) dut (
    .clk_i, .rst_ni (~in_reset), .clear_i,
    .stream_valid_i, .stream_i,
    .soft_valid_i, .soft_u_i, .soft_v_i, .load_i,
    .place_free_o (place_free), .stream_early_o (stream_early), .soft_early_o (soft_early),
    .busy_o (busy), .busy_next_o (busy_next), .tick_o (tick), .held_o (sample)
  );
  (* hierconn *) logic \dut.held_q ;
  (* hierconn *) logic \dut.load_pending_q ;
  logic held, load_pending;
  assign held = \dut.held_q ;
  assign load_pending = \dut.load_pending_q ;

  // BUSY, as the edge before said.
  logic busy_next, expected_busy;
  always @(posedge clk_i) expected_busy <= in_reset ? 1'b0 : busy_next;
  always @* if (~in_reset) assert (busy == expected_busy);

  // What happens at the coming edge.
  logic stream_latch, soft_latch, latch, commit;
  assign stream_latch = stream_valid_i & ~stream_early;
  assign soft_latch   = soft_valid_i & ~soft_early;
  assign latch        = stream_latch | soft_latch;
  assign commit       = boundary & stage[4];

  logic [3:0] latched, entered, committed;
  always @(posedge clk_i) begin
    if (in_reset | clear_i) begin
      latched   <= 4'd0;
      entered   <= 4'd0;
      committed <= 4'd0;
    end else begin
      latched   <= latched + {3'd0, latch};
      entered   <= entered + {3'd0, enter};
      committed <= committed + {3'd0, commit};
    end
  end

  // The watched sample: its number, its words, and how long it waits and works. It is chosen at its
  // latch by `choose`, which is free.
  logic        known, chosen;
  logic [4:0]  place, place_next;
  logic [3:0]  number;
  logic [31:0] known_u, known_v;
  logic        known_clip;
  logic [Bits+2:0] age;
  (* anyseq *) logic choose;
  assign chosen     = latch & choose & ~known & place == 5'd0;
  assign place_next = boundary ? {place[3:0], enter & known} : place;
  always @(posedge clk_i) begin
    if (in_reset | clear_i) begin
      known <= 1'b0;
      place <= 5'd0;
    end else begin
      known <= chosen | (known & ~enter);
      place <= place_next;
      age   <= enter & known ? '0 : age + 1'b1;
      if (chosen) begin
        number     <= latched;
        known_u    <= stream_latch ? stream_i.u : soft_u_i;
        known_v    <= stream_latch ? stream_i.v : soft_v_i;
        known_clip <= stream_latch & stream_i.clip;
      end
    end
  end

  logic [2:0] in_flight, ahead;
  assign in_flight = {2'd0, stage[0]} + {2'd0, stage[1]} + {2'd0, stage[2]} + {2'd0, stage[3]} +
                     {2'd0, stage[4]};
  // Samples in front of the watched one: those in later stages.
  logic [4:0] front;
  assign front = stage & {|place[3:0], |place[2:0], |place[1:0], place[0], 1'b0};
  assign ahead = {2'd0, front[1]} + {2'd0, front[2]} + {2'd0, front[3]} + {2'd0, front[4]};

  // How long a load has been under way that found the coprocessor idle.
  logic       load_alone;
  logic [Bits+1:0] load_age;
  always @(posedge clk_i) begin
    load_age <= load_age + 1'b1;
    if (in_reset | clear_i) load_alone <= 1'b0;
    else if (load_i & ~busy & ~latch) begin
      load_alone <= 1'b1;
      load_age   <= '0;
    end else if ((boundary & load[2]) | load_i) begin
      load_alone <= 1'b0;
    end
  end

  logic [4:0] last_cycle;
  always @(posedge clk_i) last_cycle <= cycle;

  always_comb if (~in_reset) begin
    // Latched = committed + in flight; every sample that comes is latched or reported lost.
    assert (latched == committed + {1'd0, in_flight} + {3'd0, held});
    assert (entered == committed + {1'd0, in_flight});
    assert (~(stream_valid_i & ~stream_latch) | stream_early);
    assert (~(soft_valid_i & ~soft_latch) | soft_early);
    assert (~(stream_latch & soft_latch));
    assert (~stream_early | (held & ~enter));
    assert (~soft_early | (held & ~enter) | stream_latch);
    assert (place_free == (~held | enter));

    // Content: what enters is what was latched. Order: it is committed as the number it was latched
    // as.
    if (known) assert (held & number == entered);
    if (known) assert (held_u == known_u & held_v == known_v & held_clip == known_clip);
    assert ((place & (place - 5'd1)) == 5'd0 & (place & ~stage) == 5'd0 & ~(known & |place));
    if (|place) assert (number == committed + {1'd0, ahead});
    if (commit & place[4]) assert (number == committed);

    // Latency: five ticks from entering to the commit; one more for a sample that does not wait,
    // which is latched one edge before it enters. Waiting takes less than a tick without a load.
    if (|place) begin
      assert (age == {place[4] ? 3'd4 : place[3] ? 3'd3 : place[2] ? 3'd2 : {2'd0, place[1]},
                      clock[Bits-1:0]});
    end
    if (commit & place[4]) assert (age == 5 * TickClocks - 1);
    if (held & stage == 5'd0 & load == 3'd0 & ~load_pending) assert (enter);
    if (held & boundary & ~load_pending & load[1:0] == 2'd0) assert (enter);

    // Loads: alone in the pipeline, one stage a tick.
    assert (~(|load & |stage));
    assert (load == 3'd0 | load == 3'd1 | load == 3'd2 | load == 3'd4);
    assert (~(|load_start) | boundary);
    if (load_alone & boundary & load[2]) assert (load_age == 3 * TickClocks);
    if (load_alone) assert (busy);
    if (load_alone & load != 3'd0) begin
      assert (load_age == clock + 1 + (load[0] ? 0 : load[1] ? TickClocks : 2 * TickClocks));
    end
    if (load_alone & load == 3'd0) assert (load_pending & load_age == '0 & stage == 5'd0);

    // A unit's cycles follow one another from 0 to 31, which is a boundary, with a rest after 30 in ticks of 64.
    if (stage != 5'd0 | load != 3'd0) begin
      assert (boundary == (clock == TickClocks - 1) & boundary == (cycle == 5'd31));
      assert (rest == (TickClocks == 64 & clock > 6'd30 & ~boundary));
      if (clock == 6'd0) assert (cycle == 5'd0);
      else assert (cycle == last_cycle + {4'd0, ~rest});
    end else begin
      assert (~rest);
    end

    // Idle means empty, and the cycle counter rests at 0.
    if (~busy) assert (~held & ~load_pending & stage == 5'd0 & load == 3'd0);
    if (stage == 5'd0 & load == 3'd0) assert (cycle == 5'd0 & clock == 6'd0);
    if (busy & stage == 5'd0 & load == 3'd0) assert (boundary);
  end

endmodule
