// Registers that only software writes and the pipeline reads: CTRL, steps, LOOP, thresholds,
// JUDGE, TURN_LIMIT
// (docs/coprocessor.md, "Registers"). Reserved values are refused here.
//
// Latency: a write counts from its edge on. Formats: steps u31, Q1.31; thresholds u32, Q1.31.
module setting_registers (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        clear_i,    // soft reset
  input  logic        write_i,    // of any register, but no step of 1.0 or more
  input  logic [11:0] paddr_i,
  input  logic [31:0] pwdata_i,
  output logic        reserved_o,    // CTRL.REF = 3
  output logic        demod_o,
  output logic        calib_o,
  output logic [1:0]  ref_o,
  output logic        adc_enable_o,
  output logic        ie_result_o,
  output logic        ie_lock_o,
  output logic        ie_error_o,
  output logic        ie_turn_o,
  output logic        ie_alarm_o,
  output logic        freeze_o,
  output logic [30:0] step_au_o, step_bu_o, step_cu_o, step_av_o, step_bv_o, step_cv_o,
  output logic [4:0]  kp_o,
  output logic [4:0]  ki_o,
  output logic [31:0] lock_threshold_o,
  output logic [31:0] diverge_threshold_o,
  output logic [21:0] judge_o,        // JUDGE
  output logic [31:0] turn_limit_o    // samples
);

  localparam logic [31:0] CtrlReset = capsoc_coprocessor_pkg::CTRL_RESET;
  localparam int RefLow  = capsoc_coprocessor_pkg::CTRL_REF_LSB;
  localparam int RefHigh = capsoc_coprocessor_pkg::CTRL_REF_MSB;

  logic       demod_q, calib_q, adc_q, ie_result_q, ie_lock_q, ie_error_q;
  logic       ie_turn_q, ie_alarm_q, freeze_q;
  logic [1:0] ref_q;

  logic write_ctrl;
  assign write_ctrl = write_i & paddr_i == capsoc_coprocessor_pkg::CTRL_OFFSET;

  // A word with SRST is not looked at any further.
  assign reserved_o = write_ctrl & ~clear_i & (&pwdata_i[RefHigh:RefLow]);

  logic [31:0] ctrl_data;
  assign ctrl_data = clear_i ? CtrlReset : pwdata_i;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      demod_q     <= CtrlReset[capsoc_coprocessor_pkg::CTRL_DEMOD_LSB];
      calib_q     <= CtrlReset[capsoc_coprocessor_pkg::CTRL_CALIB_LSB];
      ref_q       <= CtrlReset[RefHigh:RefLow];
      adc_q       <= CtrlReset[capsoc_coprocessor_pkg::CTRL_ADC_LSB];
      ie_result_q <= CtrlReset[capsoc_coprocessor_pkg::CTRL_IE_RESULT_LSB];
      ie_lock_q   <= CtrlReset[capsoc_coprocessor_pkg::CTRL_IE_LOCK_LSB];
      ie_error_q  <= CtrlReset[capsoc_coprocessor_pkg::CTRL_IE_ERROR_LSB];
      ie_turn_q   <= CtrlReset[capsoc_coprocessor_pkg::CTRL_IE_TURN_LSB];
      ie_alarm_q  <= CtrlReset[capsoc_coprocessor_pkg::CTRL_IE_ALARM_LSB];
      freeze_q    <= CtrlReset[capsoc_coprocessor_pkg::CTRL_FREEZE_LSB];
    end else if (write_ctrl) begin
      demod_q     <= ctrl_data[capsoc_coprocessor_pkg::CTRL_DEMOD_LSB];
      calib_q     <= ctrl_data[capsoc_coprocessor_pkg::CTRL_CALIB_LSB];
      if (!reserved_o) ref_q <= ctrl_data[RefHigh:RefLow];
      adc_q       <= ctrl_data[capsoc_coprocessor_pkg::CTRL_ADC_LSB];
      ie_result_q <= ctrl_data[capsoc_coprocessor_pkg::CTRL_IE_RESULT_LSB];
      ie_lock_q   <= ctrl_data[capsoc_coprocessor_pkg::CTRL_IE_LOCK_LSB];
      ie_error_q  <= ctrl_data[capsoc_coprocessor_pkg::CTRL_IE_ERROR_LSB];
      ie_turn_q   <= ctrl_data[capsoc_coprocessor_pkg::CTRL_IE_TURN_LSB];
      ie_alarm_q  <= ctrl_data[capsoc_coprocessor_pkg::CTRL_IE_ALARM_LSB];
      freeze_q    <= ctrl_data[capsoc_coprocessor_pkg::CTRL_FREEZE_LSB];
    end
  end
  assign demod_o      = demod_q;
  assign calib_o      = calib_q;
  assign ref_o        = ref_q;
  assign adc_enable_o = adc_q;
  assign ie_result_o  = ie_result_q;
  assign ie_lock_o    = ie_lock_q;
  assign ie_error_o   = ie_error_q;
  assign ie_turn_o    = ie_turn_q;
  assign ie_alarm_o   = ie_alarm_q;
  assign freeze_o     = freeze_q;

  // The six steps have one reset value.
  localparam logic [31:0] StepReset = capsoc_coprocessor_pkg::STEP_AU_RESET;
  logic [30:0] step_data, step_au_q, step_bu_q, step_cu_q, step_av_q, step_bv_q, step_cv_q;
  logic [5:0]  write_step;
  assign write_step = {paddr_i == capsoc_coprocessor_pkg::STEP_CV_OFFSET,
                       paddr_i == capsoc_coprocessor_pkg::STEP_BV_OFFSET,
                       paddr_i == capsoc_coprocessor_pkg::STEP_AV_OFFSET,
                       paddr_i == capsoc_coprocessor_pkg::STEP_CU_OFFSET,
                       paddr_i == capsoc_coprocessor_pkg::STEP_BU_OFFSET,
                       paddr_i == capsoc_coprocessor_pkg::STEP_AU_OFFSET} & {6{write_i}};
  assign step_data = clear_i ? StepReset[30:0] : pwdata_i[30:0];
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      step_au_q <= StepReset[30:0];
      step_bu_q <= StepReset[30:0];
      step_cu_q <= StepReset[30:0];
      step_av_q <= StepReset[30:0];
      step_bv_q <= StepReset[30:0];
      step_cv_q <= StepReset[30:0];
    end else begin
      if (clear_i | write_step[0]) step_au_q <= step_data;
      if (clear_i | write_step[1]) step_bu_q <= step_data;
      if (clear_i | write_step[2]) step_cu_q <= step_data;
      if (clear_i | write_step[3]) step_av_q <= step_data;
      if (clear_i | write_step[4]) step_bv_q <= step_data;
      if (clear_i | write_step[5]) step_cv_q <= step_data;
    end
  end
  assign step_au_o = step_au_q;
  assign step_bu_o = step_bu_q;
  assign step_cu_o = step_cu_q;
  assign step_av_o = step_av_q;
  assign step_bv_o = step_bv_q;
  assign step_cv_o = step_cv_q;

  localparam logic [31:0] LoopReset    = capsoc_coprocessor_pkg::LOOP_RESET;
  localparam logic [31:0] LockReset    = capsoc_coprocessor_pkg::LOCK_THRESHOLD_RESET;
  localparam logic [31:0] DivergeReset = capsoc_coprocessor_pkg::DIVERGE_THRESHOLD_RESET;
  localparam int KpLow  = capsoc_coprocessor_pkg::LOOP_KP_LSB;
  localparam int KpHigh = capsoc_coprocessor_pkg::LOOP_KP_MSB;
  localparam int KiLow  = capsoc_coprocessor_pkg::LOOP_KI_LSB;
  localparam int KiHigh = capsoc_coprocessor_pkg::LOOP_KI_MSB;
  localparam logic [31:0] JudgeReset   = capsoc_coprocessor_pkg::JUDGE_RESET;
  localparam logic [31:0] LimitReset   = capsoc_coprocessor_pkg::TURN_LIMIT_RESET;
  logic        write_loop, write_lock, write_diverge, write_judge, write_limit;
  logic [21:0] judge_q;
  logic [31:0] turn_limit_q;
  logic [4:0]  kp_q, ki_q;
  logic [31:0] lock_threshold_q, diverge_threshold_q;
  assign write_loop    = write_i & paddr_i == capsoc_coprocessor_pkg::LOOP_OFFSET;
  assign write_lock    = write_i & paddr_i == capsoc_coprocessor_pkg::LOCK_THRESHOLD_OFFSET;
  assign write_judge   = write_i & paddr_i == capsoc_coprocessor_pkg::JUDGE_OFFSET;
  assign write_limit   = write_i & paddr_i == capsoc_coprocessor_pkg::TURN_LIMIT_OFFSET;
  assign write_diverge = write_i & paddr_i == capsoc_coprocessor_pkg::DIVERGE_THRESHOLD_OFFSET;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      kp_q                <= LoopReset[KpHigh:KpLow];
      ki_q                <= LoopReset[KiHigh:KiLow];
      lock_threshold_q    <= LockReset;
      diverge_threshold_q <= DivergeReset;
      judge_q             <= JudgeReset[21:0];
      turn_limit_q        <= LimitReset;
    end else begin
      if (clear_i | write_loop) begin
        kp_q <= clear_i ? LoopReset[KpHigh:KpLow] : pwdata_i[KpHigh:KpLow];
        ki_q <= clear_i ? LoopReset[KiHigh:KiLow] : pwdata_i[KiHigh:KiLow];
      end
      if (clear_i | write_lock) lock_threshold_q <= clear_i ? LockReset : pwdata_i;
      if (clear_i | write_diverge) diverge_threshold_q <= clear_i ? DivergeReset : pwdata_i;
      if (clear_i | write_judge) judge_q <= clear_i ? JudgeReset[21:0] : pwdata_i[21:0];
      if (clear_i | write_limit) turn_limit_q <= clear_i ? LimitReset : pwdata_i;
    end
  end
  assign kp_o                = kp_q;
  assign ki_o                = ki_q;
  assign lock_threshold_o    = lock_threshold_q;
  assign diverge_threshold_o = diverge_threshold_q;
  assign judge_o             = judge_q;
  assign turn_limit_o        = turn_limit_q;

endmodule
