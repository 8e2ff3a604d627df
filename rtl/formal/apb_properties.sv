// The APB slave (register_bank.sv): its answers, and that only a correct access has an effect.
// `quiet` is 1 in an interval whose edge must change nothing: scripts/formal then asserts of every
// register of the bank that it keeps its value.
module apb_properties (
  input logic        clk_i,
  input logic        psel_i, penable_i, pwrite_i,
  input logic [11:0] paddr_i,
  input logic [31:0] pwdata_i,
  input logic [3:0]  pstrb_i,
  input logic        busy_i, stream_early_i, soft_early_i, boundary_i,
  input logic        phase_we_i, freq_we_i, weights_u_we_i, weights_v_we_i, parameters_we_i,
  input logic [47:0] phase_i, freq_i, au_i, bu_i, cu_i, av_i, bv_i, cv_i,
  input logic [31:0] a1_i, a2_i, b1_i, b2_i, beta_i, phi_i,
  input logic        commit_i, flag_clip_i, flag_sat_i, flag_zero_i,
  input logic        flag_diverged_i, flag_lockchg_i, flag_mirrorchg_i,
  input logic        flag_turn_i, flag_alarm_i, flag_unsettled_i,
  input logic        status_lock_i, status_diverged_i, status_mirror_i, status_valid_i, status_alarm_i,
  input logic [1:0]  status_good_turns_i,
  input logic [31:0] turn_flags_i,
  input logic [31:0] result_i
);

  logic in_reset = 1'b1;
  always @(posedge clk_i) in_reset <= 1'b0;

  logic        pready, pslverr, irq, clear, adc_enable, soft_valid, load, demod, calib;
  logic [31:0] prdata, soft_u, lock_threshold, diverge_threshold, a1, a2, b1, b2, beta, phi;
  logic [1:0]  source;
  logic [4:0]  kp, ki;
  logic [30:0] step_au, step_bu, step_cu, step_av, step_bv, step_cv;
  logic [47:0] phase, freq, au, bu, cu, av, bv, cv;
  logic [3:0]  result_select;
  logic [31:0] turn_limit;
  logic [18:0] judge;
  logic        frozen;
  register_bank dut (
    .clk_i, .rst_ni (~in_reset),
    .psel_i, .penable_i, .pwrite_i, .paddr_i, .pwdata_i, .pstrb_i,
    .pready_o (pready), .prdata_o (prdata), .pslverr_o (pslverr), .irq_o (irq),
    .clear_o (clear), .adc_enable_o (adc_enable), .soft_valid_o (soft_valid), .soft_u_o (soft_u),
    .load_o (load), .busy_i, .stream_early_i, .soft_early_i,
    .demod_o (demod), .calib_o (calib), .ref_o (source), .kp_o (kp), .ki_o (ki),
    .step_au_o (step_au), .step_bu_o (step_bu), .step_cu_o (step_cu),
    .step_av_o (step_av), .step_bv_o (step_bv), .step_cv_o (step_cv),
    .lock_threshold_o (lock_threshold), .diverge_threshold_o (diverge_threshold),
    .phase_o (phase), .freq_o (freq), .au_o (au), .bu_o (bu), .cu_o (cu),
    .av_o (av), .bv_o (bv), .cv_o (cv),
    .a1_o (a1), .a2_o (a2), .b1_o (b1), .b2_o (b2), .beta_o (beta), .phi_o (phi),
    .boundary_i, .phase_we_i, .freq_we_i, .weights_u_we_i, .weights_v_we_i, .parameters_we_i,
    .phase_i, .freq_i, .au_i, .bu_i, .cu_i, .av_i, .bv_i, .cv_i,
    .a1_i, .a2_i, .b1_i, .b2_i, .beta_i, .phi_i,
    .commit_i, .flag_clip_i, .flag_sat_i, .flag_zero_i, .flag_diverged_i, .flag_lockchg_i,
    .flag_mirrorchg_i, .status_lock_i, .status_diverged_i, .status_mirror_i, .status_valid_i,
    .flag_turn_i, .flag_alarm_i, .flag_unsettled_i, .status_alarm_i, .status_good_turns_i, .turn_flags_i,
    .turn_limit_o (turn_limit), .judge_o (judge), .frozen_o (frozen),
    .result_select_o (result_select), .result_i
  );

  // The map as the document lists it.
  logic [9:0] word;
  logic       listed, access, error, pair_high;
  assign word      = paddr_i[11:2];
  assign listed    = paddr_i[1:0] == 2'd0 & (word <= 10'h029 | (word >= 10'h02C & word <= 10'h03F &
                                                                word != 10'h03A));
  assign access    = psel_i & penable_i;
  assign error     = ~listed | (pwrite_i & pstrb_i != 4'hF);
  assign pair_high = word == 10'h007 | word == 10'h009 |
                     (word >= 10'h014 & word <= 10'h01F & word[0]);

  // Silent: no transfer, a setup phase, an access that ends in an error, a read without a latch, a
  // write to a read-only register; and neither a tick's boundary nor a lost sample.
  logic read_only;
  (* keep *) logic quiet;
  assign read_only = word == 10'h000 | word == 10'h001 | word == 10'h003 | word == 10'h013 |
                     (word >= 10'h02C & word <= 10'h03F);
  assign quiet     = ~in_reset & ~boundary_i & ~stream_early_i & ~soft_early_i &
                     (~access | error | (pwrite_i ? read_only : ~pair_high));

  always @* if (~in_reset) begin
    assert (pready);
    assert (pslverr == (access & error));
    if (~listed) assert (prdata == 32'd0);
    if (~access | error | ~pwrite_i) assert (~clear & ~soft_valid & ~load);
    if (soft_valid) assert (paddr_i == capsoc_coprocessor_pkg::SOFT_V_OFFSET);
    if (load) assert (paddr_i == capsoc_coprocessor_pkg::CMD_OFFSET & pwdata_i[capsoc_coprocessor_pkg::CMD_LOAD_LSB]);
    if (clear) assert (paddr_i == capsoc_coprocessor_pkg::CTRL_OFFSET & pwdata_i[capsoc_coprocessor_pkg::CTRL_SRST_LSB]);
    if (access & pwrite_i & ~error & paddr_i == capsoc_coprocessor_pkg::SOFT_V_OFFSET) assert (soft_valid);
    if (access & pwrite_i & ~error & paddr_i == capsoc_coprocessor_pkg::CMD_OFFSET) assert (load == pwdata_i[capsoc_coprocessor_pkg::CMD_LOAD_LSB]);
    if (access & pwrite_i & ~error & paddr_i == capsoc_coprocessor_pkg::CTRL_OFFSET) assert (clear == pwdata_i[capsoc_coprocessor_pkg::CTRL_SRST_LSB]);
  end

endmodule
