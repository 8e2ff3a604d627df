// SPDX-License-Identifier: Apache-2.0
// Datapath of the coprocessor: the arithmetic of the five stages between the registers, and the words
// and tags that travel with the samples. docs/reference/coprocessor.md has every format and rounding rule.
//
//   T0 calibrator, T1 polar unit, T3 LMS demodulator, T4 polar unit; LOAD: precise_core or paper_core
//   T2 reference generator, error average, turn judge, results: the same for both arithmetics
//
// A tick is cycles 0 to 31, with clocks in between in which tick_i.rest is 1 and every stage is as if empty.
// tick_i.boundary is 1 in the interval whose end begins a tick. Registers are read at that edge, as the bank has
// them in the interval, or as a stage writes them at its end: outputs with a write enable hold in the interval
// with a boundary. Weights Q2.46, phase and frequency 2^-48 turn, sample, amplitudes and offsets Q1.31, angles
// 2^-32 turn.
module datapath #(
  parameter int Paper = 0,
  parameter int OperandBits = 32,    // paper: of the PI arctangent's multipliers
  parameter int ReferenceLead = 0,   // paper: samples by which the reference leads its data
  parameter int StepShift = 0,       // paper: right shift of the step after its register
  parameter int PlainArctangent = 0, // paper: the arctangent's input as it is
  parameter int IterationClocks = 1, // paper: clocks of an iteration of the arctangent, 1 or 2
  parameter int Block = 1,           // precise: with block learning
  parameter int Harmonics = 1,       // precise: with the harmonic correction
  parameter int Safety = 1,          // with the safety mechanisms
  parameter int Channels = 1
) (
  input  logic        clk_i, rst_ni, clear_i,
  input  tick_t       tick_i,
  input  sample_t     held_i,           // enters T0
  input  settings_t   settings_i,
  input  correction_t correction_i,
  input  logic        frozen_i,
  input  logic        pending_i,        // FLAGS.RESULT
  input  logic        distrust_i,       // FLAGS: one of the safety mechanisms' flags
  input  logic        bad_parity_i,     // with a boundary: a register does not fit its parity bit
  input  logic        bad_safety_i,     // likewise: SAFETY does not
  input  state_t      state_i,
  output state_we_t   state_we_o,
  output state_t      state_o,
  output logic        commit_o,
  output flags_t      flags_o,          // with commit_o
  output status_t     status_o,
  output logic [31:0] turn_flags_o,
  input  logic [3:0]  result_select_i,  // results_memory.sv; 4 ANGLE
  output logic [31:0] result_o,
  // A change of context; words of the memories: of the new one, of the old one. `quality` comes out of results_memory.sv and goes into it and
  // turn_judge.sv.
  input  change_t     change_i,
  input  chain_t      chain_i,
  output chain_t      chain_o,
  input  logic [31:0] context_sample_i, context_error_i, context_quality_i,
  output logic [31:0] context_sample_o, context_error_o, context_quality_o
);

  chain_t chain_block, chain_average, chain_tags, chain_judge;

  logic boundary;
  logic [4:0] cycle, stage;
  logic [2:0] load;
  assign boundary = tick_i.boundary;
  assign cycle = tick_i.cycle;
  assign stage = tick_i.rest ? '0 : tick_i.stage;
  assign load = tick_i.rest ? '0 : tick_i.load;

  // The sample of T0; its words go to memory in the tick's first two cycles.
  logic enter;
  logic [31:0] held_u, held_v;
  logic signed [31:0] u_q, v_q;
  assign enter = tick_i.enter && boundary;
  assign held_u = held_i.u;
  assign held_v = held_i.v;
  always_ff @(posedge clk_i) begin
    if (enter) begin
      u_q <= held_u;
      v_q <= held_v;
    end
  end

  logic hold_weights, demod, demod4_q;
  assign demod = settings_i.demod;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) demod4_q <= 1'b0;
    else if (boundary) demod4_q <= demod;
  end

  core_t core;
  learning_t learning;
  logic ended, last_good, last_timeout, updates;
  logic [47:0] sum;
  logic bad_sum, bad_node;
  block_learning #(
    .Present(Paper == 0 && Block != 0 ? 1 : 0),
    .Safety (Safety),
    .Channels(Channels)
  ) u_block_learning (
    .clk_i, .rst_ni, .clear_i,
    .boundary_i    (boundary),
    .cycle_i       (cycle),
    .active_i      (stage[3]),
    .start_i       (stage[2]),
    .learns_i      (demod && !frozen_i && !hold_weights),
    .block_i       (settings_i.block),
    .guard_i       (settings_i.guard),
    .bad_parity_i  (settings_i.safety.BAD_PARITY),
    .commit_i      (commit_o),
    .ended_i       (ended),
    .good_i        (last_good),
    .timeout_i     (last_timeout),
    .learning_o    (learning),
    .weight_valid_i(core.weight_valid),
    .weight_i      (core.weight),
    .sum_o         (sum),
    .bad_sum_o     (bad_sum),
    .channel_i (change_i.channel), .shift_i (change_i.shift), .chain_i, .chain_o (chain_block)
  );
  assign updates = learning.update;
  assign state_we_o.weights_u = boundary && ((stage[3] && updates) || load[1]);
  assign state_we_o.weights_v = boundary && ((stage[3] && updates) || load[2]);
  assign state_we_o.parameters = commit_o && demod4_q;

  steps_t steps;
  weights_t weights_now, weights;
  parameters_t parameters_now, parameters;
  capsoc_coprocessor_settings_t registers;
  assign registers = settings_i.registers;
  assign steps = {registers.STEP_AU, registers.STEP_BU, registers.STEP_CU,
                  registers.STEP_AV, registers.STEP_BV, registers.STEP_CV};
  assign weights_now = state_i.weights;
  assign parameters_now = state_i.parameters;
  assign state_o.weights = weights;
  assign state_o.parameters = parameters;

  logic [31:0] residue, reference_phase, phi_now;
  logic signed [31:0] sine, cosine;
  logic turn;
  logic [4:0] saturated;
  // T4 of the last sample may end where a LOAD or a T1 begins.
  assign phi_now = state_we_o.parameters ? parameters.phi : parameters_now.phi;
  logic [31:0] relative;
  harmonic_correction #(
    .Present(Paper == 0 && Harmonics != 0 ? 1 : 0),
    .Safety (Safety),
    .Channels(Channels)
  ) u_harmonic_correction (
    .clk_i,
    .boundary_i(boundary),
    .cycle_i   (cycle),
    .start_i   (stage[0]),
    .correct_i (settings_i.correct),
    .phi_i     (phi_now),
    .write_i   (correction_i.write),
    .node_i    (correction_i.node),
    .value_i   (correction_i.value),
    .bad_parity_i(settings_i.safety.BAD_PARITY),
    .relative_i(core.relative),
    .relative_o(relative),
    .bad_node_o(bad_node),
    .channel_i (change_i.channel)
  );

  reference_generator #(
    .Paper(Paper),
    .ReferenceLead(ReferenceLead)
  ) u_reference_generator (
    .clk_i, .rst_ni,
    .boundary_i       (boundary),
    .cycle_i          (cycle),
    .start_i          (stage[1]),
    .active_i         (stage[2]),
    .load_start_i     (tick_i.load_start[0] || tick_i.load_start[1]),
    .load_active_i    (load[0] || load[1]),
    .load_phase_i     (phi_now + (tick_i.load_start[1] ? parameters_now.beta : '0)),
    .ref_i            (settings_i.source),
    .kp_i             (settings_i.kp),
    .ki_i             (settings_i.ki),
    .phase_i          (state_i.phase),
    .freq_i           (state_i.freq),
    .relative_i       (relative),
    .zero_i           (core.zero),
    .phase_we_o       (state_we_o.phase),
    .phase_o          (state_o.phase),
    .freq_we_o        (state_we_o.freq),
    .freq_o           (state_o.freq),
    .saturated_o      (saturated[2]),
    .hold_weights_o   (hold_weights),
    .turn_o           (turn),
    .reference_phase_o(reference_phase),
    .residue_o        (residue),
    .sine_o           (sine),
    .cosine_o         (cosine)
  );

  // Both arithmetics have these ports.
`define CORE_PORTS \
    .clk_i, .rst_ni, .tick_i, \
    .keep_i(state_we_o), .learning_i(learning), .sum_i(sum), \
    .u_i(u_q), .v_i(v_q), .data_i(data), .sine_i(sine), .cosine_i(cosine), \
    .steps_i(steps), .slew_i(registers.JUDGE.SLEW), \
    .weights_i(weights_now), .parameters_i(parameters_now), .relative_i(relative), \
    .bad_parity_i(settings_i.safety.BAD_PARITY), \
    .core_o(core), .weights_o(weights), .parameters_o(parameters), .bad_copy_o(bad_copy)
  logic signed [31:0] data;
  logic [31:0] angle;
  logic bad_copy;
  if (Paper != 0) begin : g_paper
    paper_core #(
      .OperandBits(OperandBits),
      .StepShift(StepShift),
      .PlainArctangent(PlainArctangent),
      .IterationClocks(IterationClocks),
      .Safety(Safety)
    ) u_core (
      `CORE_PORTS
    );
  end else begin : g_precise
    localparam int unused_settings = OperandBits + StepShift + ReferenceLead + IterationClocks;
    precise_core #(
      .Safety(Safety)
    ) u_core (
      `CORE_PORTS
    );
  end
`undef CORE_PORTS
  assign angle = core.angle;
  assign saturated[4:3] = core.saturated[4:3];
  assign saturated[1:0] = core.saturated[1:0];

  logic lock, diverged;
  logic [31:0] average;
  error_average #(
    .Channels(Channels)
  ) u_error_average (
    .clk_i, .rst_ni, .clear_i,
    .boundary_i   (boundary),
    .commit_i     (commit_o),
    .error_valid_i(core.error_valid),
    .error_i      (core.error),
    .lock_threshold_i   (registers.LOCK_THRESHOLD),
    .diverge_threshold_i(registers.DIVERGE_THRESHOLD),
    .average_o    (average),
    .lock_o       (lock),
    .diverged_o   (diverged),
    .shift_i (change_i.shift), .chain_i (chain_block), .chain_o (chain_average)
  );

  logic [3:0] findings;
  logic [29:0] step;
  logic valid, result_any, angle_any, mirror4, turn4, permits;
  logic [2:0] slot0, slot1, slot2, slot3, slot4, result_slot;
  sample_tags #(
    .Channels(Channels)
  ) u_sample_tags (
    .clk_i, .rst_ni, .clear_i,
    .boundary_i   (boundary),
    .enter_i      (tick_i.enter),
    .stage_i      (stage),
    .clip_i       (held_i.clip),
    .saturated_i  (saturated),
    .mirror_i     (core.mirror),
    .zero_i       (core.zero),
    .lock_i       (lock),
    .diverged_i   (diverged),
    .unsettled1_i (core.unsettled1),
    .turn_i       (turn),
    .unsettled4_i (core.unsettled4 && demod4_q),
    .permits_i    (permits),
    .calib_i      (settings_i.calib),
    .distrust_i   (distrust_i || |findings),
    .slot0_o      (slot0),
    .slot1_o      (slot1),
    .slot2_o      (slot2),
    .slot3_o      (slot3),
    .slot4_o      (slot4),
    .mirror4_o    (mirror4),
    .turn4_o      (turn4),
    .commit_o,
    .valid_o      (valid),
    .result_slot_o(result_slot),
    .result_any_o (result_any),
    .angle_any_o  (angle_any),
    .flag_clip_o     (flags_o.clip),
    .flag_sat_o      (flags_o.sat),
    .flag_zero_o     (flags_o.zero),
    .flag_unsettled_o(flags_o.unsettled),
    .flag_diverged_o (flags_o.diverged),
    .flag_lockchg_o  (flags_o.lockchg),
    .flag_mirrorchg_o(flags_o.mirrorchg),
    .status_lock_o    (status_o.lock),
    .status_diverged_o(status_o.diverged),
    .status_mirror_o  (status_o.mirror),
    .status_valid_o   (status_o.valid),
    .shift_i (change_i.shift), .chain_i (chain_average), .chain_o (chain_tags)
  );

  logic quality_we, record_bank, record_any;
  logic [4:0] quality_address;
  logic [31:0] quality;
  turn_judge #(
    .Channels(Channels)
  ) u_turn_judge (
    .clk_i, .rst_ni, .clear_i,
    .boundary_i       (boundary),
    .cycle_i          (cycle),
    .stage_i          (stage),
    .slot0_i          (slot0[1:0]),
    .slot1_i          (slot1),
    .slot2_i          (slot2),
    .slot3_i          (slot3[1:0]),
    .slot4_i          (slot4),
    .det_valid_i      (core.det_valid),
    .det_i            (core.det),
    .amplitude_valid_i(core.amplitude_valid),
    .amplitude_late_i (core.amplitude_late),
    .amplitude_i      (core.amplitude),
    .residue_i        (residue),
    .average_i        (average),
    .angle_i          (angle[31:2]),
    .commit_i         (commit_o),
    .clip_i           (flags_o.clip),
    .saturated_i      (flags_o.sat),
    .no_angle_i       (flags_o.zero || flags_o.unsettled),
    .mirror_i         (mirror4),
    .turn_i           (turn4),
    .octant_i         (angle[31:29]),
    .ref_i            (settings_i.source),
    .judge_i          (registers.JUDGE),
    .turn_limit_i     (registers.TURN_LIMIT),
    .write_o          (quality_we),
    .write_address_o  (quality_address),
    .write_data_o     (quality),
    .bank_o           (record_bank),
    .any_o            (record_any),
    .turn_flags_o,
    .good_turns_o     (status_o.good_turns),
    .alarm_o          (status_o.alarm),
    .ended_o          (ended),
    .last_good_o      (last_good),
    .last_timeout_o   (last_timeout),
    .alarm_next_o     (flags_o.alarm),
    .permits_o        (permits),
    .step_o           (step),
    .shift_i          (change_i.shift),
    .index_i          (change_i.index),
    .context_i        (context_quality_i),
    .chain_i          (chain_tags),
    .chain_o          (chain_judge)
  );

  safety_monitor #(
    .Present(Safety)
  ) u_safety_monitor (
    .clk_i,
    .boundary_i   (boundary),
    .safety_i     (settings_i.safety),
    .bad_parity_i, .bad_safety_i,
    .bad_node_i   (bad_node),
    .bad_sum_i    (bad_sum),
    .bad_copy_i   (bad_copy),
    .error_valid_i(core.error_valid),
    .error_i      (core.error),
    .step_i       (step),
    .pending_i,
    .findings_o   (findings)
  );
  assign flags_o.safety = findings;

  assign flags_o.turn = ended;

  logic first, second;
  logic [31:0] stored_result, angle_q;
  assign first = cycle == 5'd0;
  assign second = cycle == 5'd1;
  results_memory #(
    .Channels(Channels)
  ) u_results_memory (
    .clk_i,
    .sample_we_i   (stage[0] && (first || second || core.calibrated_valid)),
    .sample_word_i (core.calibrated_valid ? {1'b1, !core.calibrated_s} : {1'b0, second}),
    .sample_i      (core.calibrated_valid ? core.calibrated : second ? v_q : u_q),
    .sample_slot_i (slot0),
    .error_we_i    ((stage[2] && (first || second)) || core.error_valid),
    .error_word_i  (core.error_valid ? {core.error_v, !core.error_v} : {2{first}}),
    .error_i       (core.error_valid ? core.error : first ? residue : reference_phase),
    .error_slot_i  (core.error_valid ? slot3 : slot2),
    .quality_we_i  (quality_we),
    .quality_address_i(quality_address),
    .quality_i     (quality),
    .bank_i        (record_bank),
    .data_read_i   (stage[3]),
    .data_v_i      (core.data_v),
    .data_slot_i   (slot3),
    .data_o        (data),
    .select_i      (result_select_i),
    .slot_i        (result_slot),
    .result_o      (stored_result),
    .shift_i (change_i.shift), .index_i (change_i.index),
    .context_sample_i, .context_error_i, .context_sample_o, .context_error_o, .context_quality_o
  );

`ifdef VERILATOR
  // A core's words are of samples that are there, and each memory takes one in a cycle.
  always_ff @(posedge clk_i) begin
    if (rst_ni) begin
      assert (!core.det_valid || stage[0]) else $error("DET of no sample in cycle %0d", cycle);
      assert (!core.calibrated_valid || (stage[0] && !first && !second))
      else $error("a calibrated word of no sample, or beside the sample, in cycle %0d", cycle);
      assert (!core.amplitude_valid || stage[core.amplitude_late ? 2 : 1])
      else $error("an amplitude of no sample in cycle %0d", cycle);
      assert (!core.error_valid || (stage[3] && !(stage[2] && (first || second))))
      else $error("an error of no sample, or beside T2's words, in cycle %0d", cycle);
      assert (!commit_o || boundary) else $error("a commit in cycle %0d, within a tick", cycle);
    end
  end
`endif

  // ANGLE keeps its word while there is no valid one.
  logic shift;
  logic [31:0] moved;
  assign shift = Channels > 1 && change_i.shift;
  context_chain #(.Channels(Channels), .Width(32)) u_chain (
    .kept_i(angle_q), .chain_i(chain_judge), .moved_o(moved), .chain_o
  );
  always_ff @(posedge clk_i) begin
    if (commit_o && valid) angle_q <= angle;
    else if (shift) angle_q <= moved;
  end
  assign result_o = result_select_i == 4'd4 ? (angle_any ? angle_q : '0) :
                    (result_select_i > 4'd10 ? record_any : result_any) ? stored_result : '0;

  logic unused_bits;  // T2 is not the core's
  assign unused_bits = core.saturated[2] ^ change_i.clear;

endmodule
