// The datapath with the words of its bundles one by one, as the test drives and reads them.
module datapath_bench #(
  parameter int Paper = 0,
  parameter int OperandBits = 32,    // paper: of the PI arctangent's multipliers
  parameter int ReferenceLead = 0,   // paper: samples by which the reference leads its data
  parameter int StepShift = 0,       // paper: right shift of the step after its register
  parameter int PlainArctangent = 0, // paper: the arctangent's input as it is
  parameter int IterationClocks = 1  // paper: clocks of an iteration of the arctangent
) (
  input  logic               clk_i, rst_ni, clear_i, boundary_i,
  input  logic [5:0]         clock_i,
  input  logic [4:0]         cycle_i,
  input  logic               rest_i, enter_i,
  input  logic [4:0]         stage_i,
  input  logic [2:0]         load_i, load_start_i,
  input  logic signed [31:0] held_u_i, held_v_i,
  input  logic               held_clip_i, demod_i, frozen_i, calib_i, block_i, guard_i, correct_i,
  input  logic [1:0]         ref_i,
  input  logic [4:0]         kp_i, ki_i,
  input  logic [30:0]        step_au_i, step_bu_i, step_cu_i, step_av_i, step_bv_i, step_cv_i,
  input  logic [31:0]        lock_threshold_i, diverge_threshold_i, turn_limit_i,
  input  logic [21:0]        judge_i,
  input  logic               correction_write_i,
  input  logic [6:0]         correction_node_i,
  input  logic [19:0]        correction_value_i,
  input  logic [47:0]        phase_i, freq_i, au_i, bu_i, cu_i, av_i, bv_i, cv_i,
  input  logic [31:0]        a1_i, a2_i, b1_i, b2_i, beta_i, phi_i,
  output logic               phase_we_o,
  output logic [47:0]        phase_o,
  output logic               freq_we_o,
  output logic [47:0]        freq_o,
  output logic               weights_u_we_o,
  output logic [47:0]        au_o, bu_o, cu_o,
  output logic               weights_v_we_o,
  output logic [47:0]        av_o, bv_o, cv_o,
  output logic               parameters_we_o,
  output logic [31:0]        a1_o, a2_o, b1_o, b2_o, beta_o, phi_o,
  output logic               commit_o, flag_clip_o, flag_sat_o, flag_zero_o, flag_diverged_o,
  output logic               flag_lockchg_o, flag_mirrorchg_o, flag_turn_o, flag_alarm_o, flag_unsettled_o,
  input  logic [3:0]         result_select_i,
  output logic [31:0]        result_o,
  output logic               status_lock_o, status_diverged_o, status_mirror_o, status_valid_o,
  output logic               status_alarm_o,
  output logic [1:0]         status_good_turns_o,
  output logic [31:0]        turn_flags_o
);

  tick_t       tick;
  settings_t   settings;
  capsoc_coprocessor_settings_t registers;
  state_t      state, state_next;
  weights_t    weights, weights_next;
  parameters_t parameters, parameters_next;
  state_we_t   state_we;
  flags_t      flags;
  status_t     status;
  assign tick = {boundary_i, enter_i, clock_i, cycle_i, rest_i, stage_i, load_i, load_start_i};
  assign registers.STEP_AU = step_au_i;
  assign registers.STEP_BU = step_bu_i;
  assign registers.STEP_CU = step_cu_i;
  assign registers.STEP_AV = step_av_i;
  assign registers.STEP_BV = step_bv_i;
  assign registers.STEP_CV = step_cv_i;
  assign registers.LOCK_THRESHOLD = lock_threshold_i;
  assign registers.DIVERGE_THRESHOLD = diverge_threshold_i;
  assign registers.JUDGE = 32'(judge_i);
  assign registers.TURN_LIMIT = turn_limit_i;
  assign settings = {demod_i, calib_i, block_i, guard_i, correct_i, ref_i, kp_i, ki_i, registers, 32'd0};
  assign weights = {au_i, bu_i, cu_i, av_i, bv_i, cv_i};
  assign parameters = {a1_i, a2_i, b1_i, b2_i, beta_i, phi_i};
  assign state = {phase_i, freq_i, weights, parameters};

  datapath #(
    .Paper(Paper), .OperandBits(OperandBits), .ReferenceLead(ReferenceLead), .StepShift(StepShift),
    .PlainArctangent(PlainArctangent), .IterationClocks(IterationClocks)
  ) dut (
    .clk_i, .rst_ni, .clear_i, .frozen_i, .pending_i(1'b0), .distrust_i(1'b0), .bad_parity_i(1'b0), .bad_safety_i(1'b0),
    .tick_i(tick), .held_i({held_u_i, held_v_i, held_clip_i}), .settings_i(settings),
    .correction_i({correction_write_i, correction_node_i, correction_value_i}), .state_i(state),
    .state_we_o(state_we), .state_o(state_next), .commit_o, .flags_o(flags), .status_o(status),
    .turn_flags_o, .result_select_i, .result_o
  );

  assign {phase_we_o, freq_we_o, weights_u_we_o, weights_v_we_o, parameters_we_o} = state_we;
  assign {phase_o, freq_o, weights_next, parameters_next} = state_next;
  assign {au_o, bu_o, cu_o, av_o, bv_o, cv_o} = weights_next;
  assign {a1_o, a2_o, b1_o, b2_o, beta_o, phi_o} = parameters_next;
  logic [3:0] flag_safety;
  assign {flag_safety, flag_unsettled_o, flag_alarm_o, flag_turn_o, flag_mirrorchg_o, flag_diverged_o, flag_lockchg_o,
          flag_zero_o, flag_sat_o, flag_clip_o} = flags;
  assign {status_good_turns_o, status_alarm_o, status_valid_o, status_mirror_o, status_diverged_o,
          status_lock_o} = status;

endmodule
