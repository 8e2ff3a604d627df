// SPDX-License-Identifier: Apache-2.0
// Turn judge: whether the results of the last turns can be right (docs/reference/coprocessor.md, "Turn judge"),
// in T4, on one adder and one memory of words. It also writes the results AMPLITUDE and
// ERROR_AVERAGE, whose memory for the bus holds the same words as the one here.
//
// Words s32 or u32: DET, amplitude, deviation Q1.31; residue, angle 2^-32 turn; travel 2^-30 turn.
// Memory, words by sample slot: 0..7 amplitude, 8..11 average, 12..15 DET, 16..19 residue; 21 deviation;
// record of bank b: 22 + b DET, 24 + 4 b radius, residue, winding, samples.
// Two banks take turns: one is the window under way, the other the window that ended last.
// Other stages write in cycles that T4 leaves free: T2 the residue in cycle 0, T0 DET in 6, T3 the average in 26. T1
// (precise) or T2 (paper) writes the amplitude in 11. cycle_e is T4's schedule.
module turn_judge #(
  parameter int Channels = 1
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        clear_i,
  input  logic        boundary_i,
  input  logic [ 4:0] cycle_i,
  input  logic [ 4:0] stage_i,
  // Words of other stages
  input  logic [ 1:0] slot0_i,
  input  logic [ 2:0] slot1_i,
  input  logic [ 2:0] slot2_i,
  input  logic [ 1:0] slot3_i,
  input  logic [ 2:0] slot4_i,
  input  logic        det_valid_i,
  input  logic [31:0] det_i,
  input  logic        amplitude_valid_i,
  input  logic        amplitude_late_i,   // it is T2's sample's
  input  logic [31:0] amplitude_i,
  input  logic [31:0] residue_i,
  input  logic [31:0] average_i,
  // The sample in T4
  input  logic [31:2] angle_i,            // valid in cycles 30 and 31
  input  logic        commit_i,
  input  logic        clip_i,
  input  logic        saturated_i,
  input  logic        no_angle_i,
  input  logic        mirror_i,
  input  logic        turn_i,
  input  logic [ 2:0] octant_i,
  // Registers
  input  logic [ 1:0] ref_i,
  input  capsoc_coprocessor_judge_t judge_i,
  input  logic [31:0] turn_limit_i,
  // For the bus's copy of the memory
  output logic        write_o,
  output logic [ 4:0] write_address_o,
  output logic [31:0] write_data_o,
  output logic        bank_o,             // of the window that ended last
  output logic        any_o,              // there was one
  output logic [31:0] turn_flags_o,
  output logic [ 1:0] good_turns_o,
  output logic        alarm_o,
  // With commit_i: what this sample's commit makes of them
  output logic        ended_o,
  output logic        last_good_o,        // the window that ended last, this one included
  output logic        last_timeout_o,
  output logic        alarm_next_o,
  output logic        permits_o,          // LOCK, as far as the judge is concerned
  output logic [29:0] step_o,             // from the angle of the sample before; 0 for the first one
  input  logic               shift_i,
  input  logic        [ 4:0] index_i,
  input  logic [31:0] context_i,          // word index_i of the memory in a change
  input  chain_t      chain_i,
  output chain_t      chain_o
);

  // The schedule of T4. P is product_q, T is word_q, M the word read from the memory.
  typedef enum logic [4:0] {
    LoadDet         = 5'd0,   // T = DET
    RecordDet       = 5'd1,   // record: DET = T
    RadiusFirst     = 5'd2,   // P = |M| RADIUS_LIMIT >> 8, a bit of the limit a cycle; M: the record's DET
    RadiusLast      = 5'd9,
    LoadAmplitude   = 5'd10,  // T = amplitude
    SubtractDet     = 5'd11,  // T = T - |M|
    StoreDeviation  = 5'd12,  // deviation = T
    AbsDeviation    = 5'd13,  // deviation = T = |M|
    CompareRadius   = 5'd14,  // beyond: T >= P
    CompareLargest  = 5'd15,  // greater: T > M; M: the record's radius
    RecordRadius    = 5'd16,  // record: radius = T, if greater
    AlarmFirst      = 5'd17,  // P = |M| ALARM_LIMIT >> 8; M: the record's DET
    AlarmLast       = 5'd24,
    CompareAlarm    = 5'd25,  // far: deviation >= P
    AbsResidue      = 5'd26,  // T = |residue|; residue_far
    CompareResidue  = 5'd27,  // greater: T > M; M: the record's residue
    RecordResidue   = 5'd28,  // record: residue = T, if greater
    CountSample     = 5'd29,  // record: samples = T = M + 1
    TakeStep        = 5'd30,  // step = angle - last angle
    AddStep         = 5'd31   // record: winding = M + step; full: T >= TURN_LIMIT; the commit
  } cycle_e;

  // The adder's first operand
  typedef enum logic [1:0] {
    FromProduct = 2'd0,
    FromWord    = 2'd1,
    FromStep    = 2'd2,
    FromZero    = 2'd3
  } operand_e;

  // Addresses in the memory: a word of a sample is followed by its slot, the record's DET by its bank, the other words
  // of a record by bank and record_e.
  localparam logic [1:0] Amplitude = 2'b00;
  localparam logic [2:0] Average   = 3'b010;
  localparam logic [2:0] Det       = 3'b011;
  localparam logic [2:0] Residue   = 3'b100;
  localparam logic [4:0] Deviation = 5'd21;
  localparam logic [3:0] DetRecord = 4'b1011;
  localparam logic [1:0] Record    = 2'b11;
  typedef enum logic [1:0] {
    RadiusWord  = 2'd0,
    ResidueWord = 2'd1,
    WindingWord = 2'd2,
    SamplesWord = 2'd3
  } record_e;

  // Places in the window's flags, TURN_FLAGS[23:0]
  localparam int TimeoutFlag = 16;
  localparam int GoodFlag    = 22;

  localparam logic [1:0] GoodTurnsMost = 2'd3;

  logic active;
  assign active = stage_i[4];

  // Registers as they were at the tick's start.
  logic [7:0] radius_limit_q, alarm_limit_q;
  logic [1:0] turns_q;
  logic count_q, by_angle_q;
  logic [31:0] turn_limit_q;
  always_ff @(posedge clk_i) begin
    if (boundary_i) begin
      count_q <= judge_i.COUNT;
      turns_q <= judge_i.TURNS;
      alarm_limit_q <= judge_i.ALARM_LIMIT;
      radius_limit_q <= judge_i.RADIUS_LIMIT;
      turn_limit_q <= turn_limit_i;
      by_angle_q <= ref_i != '0;
    end
  end

  // What a channel keeps, in addition to its record.
  logic shift;
  logic [95:0] moved;
  assign shift = Channels > 1 && shift_i;

  // The schedule.
  logic multiply, alarm_product, absolute, minus_one, first;
  logic any_sample_q;
  // Two bits: a bit for each operand would cost a larger LUT.
  (* fsm_encoding = "none" *) logic [1:0] a_select_q;  // operand_e
  assign first = cycle_i == RecordDet;
  assign alarm_product = cycle_i[4];
  assign multiply = (cycle_i >= RadiusFirst && cycle_i <= RadiusLast) ||
      (cycle_i >= AlarmFirst && cycle_i <= AlarmLast);
  assign absolute = multiply || cycle_i == AbsDeviation || cycle_i == AbsResidue;
  // T - M - 1 is negative unless T > M; P - M - 1 is negative if M >= P.
  assign minus_one = cycle_i == CompareRadius || cycle_i == CompareLargest ||
      cycle_i == CompareAlarm || cycle_i == CompareResidue;
  // Set a cycle ahead, so that the choice of three operands is one LUT a bit. A product begins with 0, in cycles RadiusFirst
  // and AlarmFirst.
  always_ff @(posedge clk_i) begin
    if (boundary_i) begin
      a_select_q <= FromZero;
    end else if (active) begin
      unique case (cycle_i)
        LoadDet, LoadAmplitude, SubtractDet, CompareRadius, CompareLargest, AbsResidue, CompareResidue:
          a_select_q <= FromWord;
        TakeStep: a_select_q <= any_sample_q ? FromStep : FromZero;
        RecordDet, RadiusLast, StoreDeviation, RecordRadius, CompareAlarm, RecordResidue: a_select_q <= FromZero;
        default: a_select_q <= FromProduct;
      endcase
    end
  end

  // The word that is read, and the one that T4 writes. A record's words count from the window's second
  // sample on.
  logic fresh_q, bank_q;
  logic [4:0] own_address;
  logic of_record;
  always_comb begin
    of_record = 1'b0;
    unique case (cycle_i)
      LoadDet: own_address = {Det, slot4_i[1:0]};
      LoadAmplitude: own_address = {Amplitude, slot4_i};
      StoreDeviation, AbsDeviation, CompareRadius, CompareAlarm: own_address = Deviation;
      CompareLargest, RecordRadius: begin own_address = {Record, bank_q, RadiusWord}; of_record = 1'b1; end
      AbsResidue: own_address = {Residue, slot4_i[1:0]};
      CompareResidue, RecordResidue: begin own_address = {Record, bank_q, ResidueWord}; of_record = 1'b1; end
      CountSample: begin own_address = {Record, bank_q, SamplesWord}; of_record = 1'b1; end
      AddStep: begin own_address = {Record, bank_q, WindingWord}; of_record = 1'b1; end
      default: own_address = {DetRecord, bank_q};
    endcase
  end

  logic [31:0] words[0:31];
  logic [31:0] word;
  assign word = words[own_address];

  // Adder: A is P, T, the step or 0; B is M or 0, added or subtracted. A sum of 34 bits.
  logic [32:0] product_q;
  logic [32:0] word_q;
  logic [29:0] step_q;
  logic [33:0] a, b;
  logic use_b, minus, carry, is_signed, limit_bit;
  logic [2:0] bit_number;
  assign bit_number = cycle_i[2:0] - (alarm_product ? 3'(AlarmFirst) : 3'(RadiusFirst));
  assign limit_bit = alarm_product ? alarm_limit_q[bit_number] : radius_limit_q[bit_number];
  always_comb begin
    if (multiply) use_b = limit_bit;
    else if (first || cycle_i == StoreDeviation || cycle_i == RecordRadius || cycle_i == RecordResidue) use_b = 1'b0;
    else use_b = !(of_record && fresh_q);
  end
  assign is_signed = absolute || cycle_i == SubtractDet || cycle_i == AddStep;
  assign minus = absolute ? word[31] && use_b : cycle_i == SubtractDet ? !word[31] : minus_one;
  assign carry = cycle_i == CountSample || (minus && !minus_one);
  always_comb begin
    unique case (a_select_q)
      FromProduct: a = {1'b0, product_q};
      FromWord: a = {word_q[32], word_q};
      FromStep: a = {{4{step_q[29]}}, step_q};
      default: a = '0;
    endcase
  end
  assign b = {{2{is_signed && word[31]}}, word} & {34{use_b}};
  logic [33:0] sum;
  add_subtract #(.Width(34)) u_sum (
    .a_i(a), .b_i(b), .minus_i(minus), .carry_i(carry), .sum_o(sum)
  );

  // What the cycles find; beyond, far and residue_far wait for the commit.
  logic beyond_q, far_q, greater_q, residue_far_q;
  always_ff @(posedge clk_i) begin
    if (active) begin
      if (multiply) product_q <= sum[33:1];
      if (cycle_i == LoadDet || cycle_i == LoadAmplitude || cycle_i == SubtractDet || cycle_i == AbsDeviation ||
          cycle_i == AbsResidue || cycle_i == CountSample) word_q <= sum[32:0];
      if (cycle_i == CompareRadius) beyond_q <= sum[33];
      if (cycle_i == CompareAlarm) far_q <= sum[33];
      if (cycle_i == AbsResidue) residue_far_q <= sum[31:28] != '0;  // 1/16 turn or more
      if (cycle_i == CompareLargest || cycle_i == CompareResidue) greater_q <= !sum[33] || fresh_q;
    end
  end

  // Writing: the stages share one port.
  logic residue_valid, average_valid, own;
  assign residue_valid = stage_i[2] && cycle_i == LoadDet;
  assign average_valid = stage_i[3] && cycle_i == AbsResidue;
  always_comb begin
    unique case (cycle_i)
      RecordDet, StoreDeviation, AbsDeviation, CountSample, AddStep: own = 1'b1;
      RecordRadius, RecordResidue: own = greater_q;
      default: own = 1'b0;
    endcase
  end
  logic [31:0] stage_word;
  assign stage_word = det_valid_i ? det_i : average_valid ? average_i : amplitude_i;
  assign write_o = residue_valid || det_valid_i || amplitude_valid_i || average_valid ||
      (active && own) || shift;
  always_comb begin
    if (shift) write_data_o = context_i;
    else if (residue_valid) write_data_o = residue_i;
    else if (det_valid_i || amplitude_valid_i || average_valid) write_data_o = stage_word;
    else write_data_o = sum[31:0];
  end
  always_comb begin
    if (shift) write_address_o = index_i;
    else if (residue_valid) write_address_o = {Residue, slot2_i[1:0]};
    else if (det_valid_i) write_address_o = {Det, slot0_i};
    else if (amplitude_valid_i) write_address_o = {Amplitude, amplitude_late_i ? slot2_i : slot1_i};
    else if (average_valid) write_address_o = {Average, slot3_i};
    else write_address_o = own_address;
  end
  always_ff @(posedge clk_i) begin
    if (write_o) words[write_address_o] <= write_data_o;
  end

`ifdef VERILATOR
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (rst_ni) begin
      assert ($onehot0({residue_valid, det_valid_i, amplitude_valid_i, average_valid, active && own}))
      else $error("two stages write a word in cycle %0d", cycle_i);
      assert (!commit_i || (active && cycle_i == AddStep))
      else $error("commit in cycle %0d of stages %b", cycle_i, stage_i);
    end
  end
`endif

  // The angle's way. The step is taken in cycle 30, before the angle is the last one.
  logic [29:0] last_angle_q, step_d;
  add_subtract #(.Width(30)) u_step (
    .a_i(angle_i), .b_i(last_angle_q), .minus_i(1'b1), .carry_i(1'b1), .sum_o(step_d)
  );
  always_ff @(posedge clk_i) begin
    if (active && cycle_i == TakeStep) step_q <= step_d;
    if (commit_i) last_angle_q <= angle_i;
    else if (shift) last_angle_q <= moved[95:66];
  end

  assign step_o = step_q & {30{any_sample_q}};

  // The window's flags with this sample.
  logic [7:0] octants_q, octants, clipped_q, clipped;
  logic radius_q, wild_q, mirror_q, no_angle_q, saturated_q, residue_q;
  logic radius, wild, mirror, no_angle, saturated, residue;
  assign octants = (octants_q & {8{!fresh_q}}) | (8'd1 << octant_i);
  assign clipped = (clipped_q & {8{!fresh_q}}) +
      8'(clip_i && !(&clipped_q && !fresh_q));
  assign radius = (radius_q && !fresh_q) || (beyond_q && radius_limit_q != '0);
  assign wild = (wild_q && !fresh_q) || sum[31:29] == 3'b100 || sum[31:29] == 3'b011;
  assign mirror = (mirror_q && !fresh_q) || mirror_i;
  assign no_angle = (no_angle_q && !fresh_q) || no_angle_i;
  assign saturated = (saturated_q && !fresh_q) || saturated_i;
  assign residue = (residue_q && !fresh_q) || residue_far_q;
  always_ff @(posedge clk_i) begin
    if (commit_i) begin
      octants_q <= octants;
      clipped_q <= clipped;
      {radius_q, wild_q, mirror_q, no_angle_q, saturated_q, residue_q} <=
          {radius, wild, mirror, no_angle, saturated, residue};
    end else if (shift) begin
      {octants_q, clipped_q, radius_q, wild_q, mirror_q, no_angle_q, saturated_q, residue_q} <= moved[65:44];
    end
  end

  // Its end.
  logic full, complete, timeout, one_turn, winding, fault, good;
  logic [6:0] upper;  // 1/64 turn: 61 .. 66 and -67 .. -62 differ in the sign alone
  assign upper = sum[30:24];
  assign full = word_q[31:0] >= turn_limit_q && turn_limit_q != '0;
  assign complete = !count_q && (by_angle_q ? sum[31] != sum[30] : turn_i);
  assign ended_o = complete || full;
  assign timeout = full && !complete && !count_q;
  always_comb begin
    unique case (upper)
      7'd61, 7'd62, 7'd63, 7'd64, 7'd65, 7'd66: one_turn = 1'b1;
      default: one_turn = 1'b0;
    endcase
  end
  assign winding = wild || !one_turn;
  assign fault = clipped != '0 || radius || mirror || no_angle || saturated || residue;
  assign good = &octants && !timeout && !fault && (count_q || !winding);

  // The alarm.
  logic [4:0] glitches_q, glitches;
  logic glitch, alarm_q;
  assign glitch = (far_q && alarm_limit_q != '0) || clip_i;
  always_comb begin
    glitches = glitches_q + {{4{!glitch}}, 1'b1};
    if (glitch ? glitches_q[4] : glitches_q == '0) glitches = glitches_q;
  end
  assign alarm_next_o = glitches[4] || (alarm_q && glitches != '0);

  logic [1:0] good_turns_q, good_turns;
  always_comb begin
    good_turns = good_turns_q;
    if (ended_o) good_turns = good ? good_turns_q + 2'(good_turns_q != GoodTurnsMost) : '0;
    if (alarm_next_o) good_turns = '0;
  end
  assign permits_o = !alarm_next_o && good_turns >= turns_q && (turns_q == '0 || !fault);

  logic any_q;
  logic [7:0] turn_count_q;
  logic [23:0] flags, flags_q;
  assign flags = {residue, good, saturated, no_angle, mirror, winding, radius, timeout, clipped, octants};
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      {fresh_q, bank_q, any_q, any_sample_q, alarm_q} <= 5'b10000;
      {glitches_q, good_turns_q, turn_count_q, flags_q} <= '0;
    end else if (clear_i) begin
      {fresh_q, bank_q, any_q, any_sample_q, alarm_q} <= 5'b10000;
      {glitches_q, good_turns_q, turn_count_q, flags_q} <= '0;
    end else if (commit_i) begin
      fresh_q <= ended_o;
      any_sample_q <= 1'b1;
      alarm_q <= alarm_next_o;
      glitches_q <= glitches;
      good_turns_q <= good_turns;
      if (ended_o) begin
        bank_q <= !bank_q;
        any_q <= 1'b1;
        turn_count_q <= turn_count_q + 8'd1;
        flags_q <= flags;
      end
    end else if (shift) begin
      {fresh_q, bank_q, any_q, any_sample_q, alarm_q, glitches_q, good_turns_q, turn_count_q, flags_q} <= moved[43:0];
    end
  end
  logic ends;
  assign ends = commit_i && ended_o;
  assign last_good_o = ends ? good : flags_q[GoodFlag];
  assign last_timeout_o = ends ? timeout : flags_q[TimeoutFlag];
  assign bank_o = !bank_q;
  assign any_o = any_q;
  assign turn_flags_o = {turn_count_q, flags_q};
  assign good_turns_o = good_turns_q;
  assign alarm_o = alarm_q;

  context_chain #(.Channels(Channels), .Width(96)) u_chain (
    .kept_i({last_angle_q, octants_q, clipped_q, radius_q, wild_q, mirror_q, no_angle_q, saturated_q, residue_q,
             fresh_q, bank_q, any_q, any_sample_q, alarm_q, glitches_q, good_turns_q, turn_count_q, flags_q}),
    .chain_i, .moved_o(moved), .chain_o
  );

  logic unused_bits;
  assign unused_bits = ^{stage_i[1:0], judge_i.RESERVED_31_22, judge_i.SLEW};

endmodule
