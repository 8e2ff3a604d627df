// SPDX-License-Identifier: Apache-2.0
// Checks each cycle of the turn judge's schedule against its definition (turn_judge.sv, docs/reference/coprocessor.md).
// Covers, from any state and with any word read, what it writes and reports at the commit.
// Also covers each register's value after the cycle, after SRST and after the pin's reset.
module turn_judge_properties (
  input logic        clk_i, rst_ni, clear_i, boundary_i,
  input logic [ 4:0] cycle_i, stage_i,
  input logic [ 2:0] slot1_i, slot2_i, slot4_i,
  input logic [ 1:0] slot0_i, slot3_i,
  input logic        det_valid_i, amplitude_valid_i, amplitude_late_i,
  input logic [31:0] det_i, amplitude_i, residue_i, average_i,
  input logic [31:2] angle_i,
  input logic        clip_i, saturated_i, no_angle_i, mirror_i, turn_i,
  input logic [ 2:0] octant_i,
  input logic [ 1:0] ref_i,
  input capsoc_coprocessor_judge_t judge_i,
  input logic [31:0] turn_limit_i
);

  logic        write, bank, any, alarm, ended, alarm_next, permits, commit, last_good, last_timeout;
  logic [ 4:0] address;
  logic [31:0] data, turn_flags;
  logic [ 1:0] good_turns;
  assign commit = stage_i[4] && cycle_i == 5'd31;
  turn_judge dut (
    .clk_i, .rst_ni, .clear_i, .boundary_i, .cycle_i, .stage_i,
    .slot0_i, .slot1_i, .slot2_i, .slot3_i, .slot4_i,
    .det_valid_i, .det_i, .amplitude_valid_i, .amplitude_late_i, .amplitude_i, .residue_i, .average_i,
    .angle_i, .commit_i (commit), .clip_i, .saturated_i, .no_angle_i, .mirror_i, .turn_i, .octant_i,
    .ref_i, .judge_i, .turn_limit_i,
    .write_o (write), .write_address_o (address), .write_data_o (data),
    .bank_o (bank), .any_o (any), .turn_flags_o (turn_flags), .good_turns_o (good_turns),
    .alarm_o (alarm), .ended_o (ended), .last_good_o (last_good), .last_timeout_o (last_timeout), .alarm_next_o (alarm_next), .permits_o (permits)
  );

  (* hierconn *) logic [31:0] \dut.word ;
  (* hierconn *) logic [32:0] \dut.product_q ;
  (* hierconn *) logic [32:0] \dut.word_q ;
  (* hierconn *) logic [29:0] \dut.step_q ;
  (* hierconn *) logic [ 1:0] \dut.a_select_q ;
  (* hierconn *) logic [29:0] \dut.last_angle_q ;
  (* hierconn *) logic [ 7:0] \dut.radius_limit_q ;
  (* hierconn *) logic [ 7:0] \dut.alarm_limit_q ;
  (* hierconn *) logic [31:0] \dut.turn_limit_q ;
  (* hierconn *) logic [ 1:0] \dut.turns_q ;
  (* hierconn *) logic \dut.count_q ;
  (* hierconn *) logic \dut.by_angle_q ;
  (* hierconn *) logic \dut.fresh_q ;
  (* hierconn *) logic \dut.bank_q ;
  (* hierconn *) logic \dut.any_sample_q ;
  (* hierconn *) logic \dut.beyond_q ;
  (* hierconn *) logic \dut.far_q ;
  (* hierconn *) logic \dut.greater_q ;
  (* hierconn *) logic \dut.wild_q ;
  (* hierconn *) logic \dut.radius_q ;
  (* hierconn *) logic \dut.mirror_q ;
  (* hierconn *) logic \dut.no_angle_q ;
  (* hierconn *) logic \dut.saturated_q ;
  (* hierconn *) logic [7:0] \dut.octants_q ;
  (* hierconn *) logic [7:0] \dut.clipped_q ;
  (* hierconn *) logic [4:0] \dut.glitches_q ;
  (* hierconn *) logic [1:0] \dut.good_turns_q ;
  (* hierconn *) logic \dut.residue_far_q ;
  (* hierconn *) logic \dut.residue_q ;
  (* hierconn *) logic [23:0] \dut.flags ;

  // Short names; P, T, M as in the unit's text.
  logic [31:0] m, size;
  logic [32:0] p, t;
  logic active, fresh, limit_bit;
  logic [7:0] limit;
  assign m      = \dut.word ;
  assign size   = m[31] ? -m : m;
  assign p      = \dut.product_q ;
  assign t      = \dut.word_q ;
  assign active = stage_i[4];
  assign fresh  = \dut.fresh_q ;
  assign limit  = cycle_i < 5'd16 ? \dut.radius_limit_q : \dut.alarm_limit_q ;
  assign limit_bit = limit[cycle_i < 5'd16 ? 3'(cycle_i - 5'd2) : 3'(cycle_i - 5'd17)];

  // A product's bits one after the other: floors of floors are the floor of the whole. P stays below 2^32
  // and T, where it is a size, at or below 2^31.
  logic [33:0] sum;
  logic        multiplies;
  assign sum        = (cycle_i == 5'd2 || cycle_i == 5'd17 ? 34'd0 : {1'b0, p}) + (limit_bit ? {2'd0, size} : 34'd0);
  assign multiplies = (cycle_i >= 5'd2 && cycle_i <= 5'd9) || (cycle_i >= 5'd17 && cycle_i <= 5'd24);

  // What the registers hold after this cycle.
  logic [32:0] p_due, t_due;
  logic beyond_due, far_due, greater_due, residue_far_due;
  logic [29:0] step_due;
  always @* begin
    p_due = p;
    t_due = t;
    {beyond_due, far_due, greater_due, residue_far_due} =
        {\dut.beyond_q , \dut.far_q , \dut.greater_q , \dut.residue_far_q };
    step_due = \dut.step_q ;
    if (active) begin
      if (multiplies) p_due = sum[33:1];
      case (cycle_i)
        5'd0, 5'd10: t_due = {1'b0, m};
        5'd11: t_due = t - {1'b0, size};
        5'd13, 5'd26: t_due = {1'b0, size};
        5'd29: t_due = fresh ? 33'd1 : {1'b0, m} + 33'd1;
        default: t_due = t;
      endcase
      if (cycle_i == 5'd14) beyond_due = {1'b0, m} >= p;
      if (cycle_i == 5'd25) far_due = {1'b0, m} >= p;
      if (cycle_i == 5'd26) residue_far_due = size >= 32'h1000_0000;
      if (cycle_i == 5'd15 || cycle_i == 5'd27) greater_due = fresh || t > {1'b0, m};
      if (cycle_i == 5'd30) begin
        step_due = angle_i - \dut.last_angle_q ;
      end
    end
  end

  // The adder's first word, chosen a cycle ahead: 0 P, 1 T, 2 the step, 3 nothing.
  function automatic logic [1:0] choice(input logic [4:0] cycle, input logic any_sample);
    case (cycle)
      5'd1, 5'd11, 5'd12, 5'd15, 5'd16, 5'd27, 5'd28: choice = 2'd1;
      5'd31: choice = any_sample ? 2'd2 : 2'd3;
      5'd0, 5'd2, 5'd10, 5'd13, 5'd17, 5'd26, 5'd29: choice = 2'd3;
      default: choice = 2'd0;
    endcase
  endfunction
  logic follows = 1'b0;
  logic [1:0] choice_was;
  always @(posedge clk_i) begin
    follows    <= boundary_i || (active && cycle_i != 5'd31);  // cycle 0 comes after a boundary alone
    choice_was <= boundary_i ? 2'd3 : choice(cycle_i + 5'd1, \dut.any_sample_q );
  end

  logic known = 1'b0;
  logic [32:0] p_was, t_was;
  logic [3:0] found_was;
  logic [29:0] step_was;
  always @(posedge clk_i) begin
    known     <= 1'b1;
    p_was     <= p_due;
    t_was     <= t_due;
    found_was <= {beyond_due, far_due, greater_due, residue_far_due};
    step_was  <= step_due;
  end

  // At the commit.
  logic [31:0] travel;
  logic wild, one_turn, complete, glitch, radius, mirror, no_angle, saturated, residue, full, timeout, good, fault;
  logic [4:0] glitches;
  logic [7:0] octants, clipped;
  logic [1:0] turns;
  assign travel = (fresh ? 32'd0 : m) +
      (\dut.any_sample_q ? {{2{\dut.step_q [29]}}, \dut.step_q } : 32'd0);
  assign wild = (\dut.wild_q && !fresh) || $signed(travel) < -32'sd1610612736 ||
      $signed(travel) >= 32'sd1610612736;
  assign one_turn = ($signed(travel) >= 32'sd1023410176 && $signed(travel) < 32'sd1124073472) ||
      ($signed(travel) >= -32'sd1124073472 && $signed(travel) < -32'sd1023410176);
  assign complete = !\dut.count_q && (\dut.by_angle_q ?
      $signed(travel) >= 32'sd1073741824 || $signed(travel) < -32'sd1073741824 : turn_i);
  assign full      = \dut.turn_limit_q != '0 && t[31:0] >= \dut.turn_limit_q ;
  assign timeout   = full && !complete && !\dut.count_q ;
  assign glitch    = clip_i || (\dut.far_q && \dut.alarm_limit_q != '0);
  assign radius    = (\dut.radius_q && !fresh) || (\dut.beyond_q && \dut.radius_limit_q != '0);
  assign mirror    = (\dut.mirror_q && !fresh) || mirror_i;
  assign no_angle  = (\dut.no_angle_q && !fresh) || no_angle_i;
  assign saturated = (\dut.saturated_q && !fresh) || saturated_i;
  assign residue   = (\dut.residue_q && !fresh) || \dut.residue_far_q ;
  assign octants   = (fresh ? 8'd0 : \dut.octants_q ) | (8'd1 << octant_i);
  assign clipped   = (fresh ? 8'd0 : \dut.clipped_q ) +
      8'(clip_i && (fresh || \dut.clipped_q != 8'd255));
  assign glitches  = glitch ? (\dut.glitches_q == 5'd16 ? 5'd16 : \dut.glitches_q + 5'd1)
                            : (\dut.glitches_q == 5'd0 ? 5'd0 : \dut.glitches_q - 5'd1);
  assign fault = radius || mirror || no_angle || saturated || residue || clipped != 8'd0;
  assign good = octants == 8'hFF && !timeout && !fault && (\dut.count_q || (one_turn && !wild));
  always @* begin
    turns = \dut.good_turns_q ;
    if (complete || full) turns = !good ? 2'd0 : turns == 2'd3 ? 2'd3 : turns + 2'd1;
    if (alarm_next) turns = 2'd0;
  end

  // Register values after this cycle: the settings of a tick, the state after a commit, and after a reset.
  logic [51:0] settings, settings_was;
  assign settings = {\dut.count_q , \dut.by_angle_q , \dut.turns_q , \dut.alarm_limit_q , \dut.radius_limit_q ,
                     \dut.turn_limit_q };
  logic [51:0] window, window_was;  // no reset: a window's first sample does not look at it
  assign window = {\dut.last_angle_q , \dut.octants_q , \dut.clipped_q , \dut.radius_q , \dut.wild_q , \dut.mirror_q ,
                   \dut.no_angle_q , \dut.saturated_q , \dut.residue_q };
  logic [43:0] state, state_was;
  assign state = {\dut.fresh_q , \dut.bank_q , any, \dut.any_sample_q , alarm, \dut.glitches_q , \dut.good_turns_q ,
                  turn_flags};
  localparam logic [43:0] Reset = {1'b1, 43'd0};
  logic reset_was;
  always @(posedge clk_i) begin
    settings_was <= boundary_i ? {judge_i.COUNT, ref_i != 2'd0, judge_i.TURNS, judge_i.ALARM_LIMIT, judge_i.RADIUS_LIMIT,
                                  turn_limit_i} : settings;
    window_was   <= commit ? {angle_i, octants, clipped, radius, wild, mirror, no_angle, saturated, residue} : window;
    reset_was    <= clear_i || !rst_ni;
    state_was    <= !commit ? state :
        {ended, \dut.bank_q ^ ended, any || ended, 1'b1, alarm_next, glitches, turns,
         ended ? {turn_flags[31:24] + 8'd1, \dut.flags } : turn_flags};
  end

  always @* begin
    if (known && rst_ni) assert (state == (reset_was ? Reset : state_was));
    if (!rst_ni) assert (state == Reset);
    if (known) assert (settings == settings_was && window == window_was);
    assert (bank == !\dut.bank_q && good_turns == \dut.good_turns_q );
    assert (last_good == (commit && ended ? \dut.flags [22] : turn_flags[22]));
    assert (last_timeout == (commit && ended ? \dut.flags [16] : turn_flags[16]));
  end

  always @* begin
    assume (\dut.glitches_q <= 5'd16);
    assume (p < 33'h1_0000_0000);
    assume (cycle_i < 5'd10 || cycle_i > 5'd16 || cycle_i == 5'd11 || cycle_i == 5'd12 || t <= 33'h8000_0000);
    if (cycle_i == 5'd11) assume (t < 33'h8000_0000);
    if (cycle_i == 5'd27 || cycle_i == 5'd28) assume (t <= 33'h8000_0000);
    // The sequencer's: the other stages' words come in their own cycles.
    assume (!det_valid_i || cycle_i == 5'd6);
    assume (!amplitude_valid_i || cycle_i == 5'd11);
    if (active) assume (\dut.a_select_q == choice(cycle_i, \dut.any_sample_q ) || cycle_i == 5'd30);
    if (follows) assert (\dut.a_select_q == choice_was);
    if (known) begin
      assert (\dut.product_q == p_was);
      assert (\dut.word_q == t_was);
      assert ({\dut.beyond_q , \dut.far_q , \dut.greater_q , \dut.residue_far_q } == found_was);
      assert (\dut.step_q == step_was);
    end
    if (active) begin
      if (cycle_i == 5'd1) assert (write && data == t[31:0] && address == {4'b1011, \dut.bank_q });
      if (cycle_i == 5'd12) assert (write && data == t[31:0] && address == 5'd21);
      if (cycle_i == 5'd13) assert (write && data == size && address == 5'd21);
      if (cycle_i == 5'd16) begin
        assert (write == \dut.greater_q );
        if (write) assert (data == t[31:0] && address == {2'b11, \dut.bank_q , 2'd0});
      end
      if (cycle_i == 5'd28) begin
        assert (write == \dut.greater_q );
        if (write) assert (data == t[31:0] && address == {2'b11, \dut.bank_q , 2'd1});
      end
      if (cycle_i == 5'd29)
        assert (write && data == (fresh ? 32'd1 : m + 32'd1) && address == {2'b11, \dut.bank_q , 2'd3});
    end
    if (commit) begin
      assert (write && data == travel && address == {2'b11, \dut.bank_q , 2'd2});
      assert (\dut.flags == {residue, good, saturated, no_angle, mirror, wild || !one_turn, radius, timeout, clipped,
                             octants});
      assert (ended == (complete || full));
      assert (alarm_next == (glitches == 5'd16 || (alarm && glitches != 5'd0)));
      assert (permits == (!alarm_next && turns >= \dut.turns_q && !(\dut.turns_q != 2'd0 && fault)));
    end
    // Words of other stages, under their sample's slot.
    if (stage_i[2] && cycle_i == 5'd0)
      assert (write && data == residue_i && address == {3'b100, slot2_i[1:0]});
    if (det_valid_i) assert (write && data == det_i && address == {3'b011, slot0_i});
    if (amplitude_valid_i)
      assert (write && data == amplitude_i && address == {2'b00, amplitude_late_i ? slot2_i : slot1_i});
    if (stage_i[3] && cycle_i == 5'd26)
      assert (write && data == average_i && address == {3'b010, slot3_i});
  end

endmodule
