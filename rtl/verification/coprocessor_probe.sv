// Verification wrapper of the coprocessor: the design as `dut`, and inside values as ports, taken by
// hierarchical reference. Not part of the design.
//
// A node is captured at the falling edge in the middle of the interval in which it is valid (see
// docs/coprocessor.md for formats); node_NAME_o then holds it to the end of the tick at the least.
// Inputs are taken over at the rising edge of drive_i, which costs the simulator less than inputs that
// might change at any time: nothing behind them is evaluated while they rest.
// The model_NAME_i inputs go nowhere: they put the model's nodes into the same wave file.
// Signed words are sign-extended to 64 bits, others zero-extended.
module coprocessor_probe #(
  parameter int Paper         = 0,
  parameter int OperandBits   = 32,
  parameter int ReferenceLead = 0,
  parameter int StepShift     = 0
) (
  input  logic        pclk_i,
  input  logic        drive_i,
  input  logic        presetn_i,
  input  logic        psel_i,
  input  logic        penable_i,
  input  logic        pwrite_i,
  input  logic [11:0] paddr_i,
  input  logic [31:0] pwdata_i,
  input  logic [3:0]  pstrb_i,
  output logic        pready_o,
  output logic [31:0] prdata_o,
  output logic        pslverr_o,
  input  logic        sample_valid_i,
  input  logic [31:0] sample_u_i,
  input  logic [31:0] sample_v_i,
  input  logic        sample_clip_i,
  output logic        sample_ready_o,
  output logic        irq_o,
  output logic        idle_o,
  // Sequencer
  output logic        boundary_o,
  output logic        enter_o,
  output logic [4:0]  cycle_o,
  output logic [4:0]  stage_o,
  output logic [2:0]  load_o,
  output logic [2:0]  load_start_o,
  output logic        held_o,
  output logic        load_pending_o,
  output logic        running_o,
  output logic        commit_o,
  // 48-bit registers
  output logic [47:0] phase_o, freq_o, au_o, bu_o, cu_o, av_o, bv_o, cv_o,
  // Nodes, RTL and model
  output logic [63:0]
    node_u_o,
    node_v_o,
    node_clip_o,
    node_s_high_o,
    node_s_low_o,
    node_c_high_o,
    node_c_low_o,
    node_mirror_o,
    node_cal_s_o,
    node_cal_c_o,
    node_det_o,
    node_saturated_t0_o,
    node_relative_o,
    node_amplitude_o,
    node_zero_o,
    node_unsettled_t1_o,
    node_saturated_t1_o,
    node_reference_phase_o,
    node_residue_o,
    node_sine_o,
    node_cosine_o,
    node_next_phase_o,
    node_next_frequency_o,
    node_turn_o,
    node_saturated_t2_o,
    node_error_u_o,
    node_error_v_o,
    node_next_a_u_o,
    node_next_b_u_o,
    node_next_c_u_o,
    node_next_a_v_o,
    node_next_b_v_o,
    node_next_c_v_o,
    node_next_average_o,
    node_saturated_t3_o,
    node_found_phi_o,
    node_found_a1_o,
    node_found_beta_o,
    node_found_a2_o,
    node_found_b1_o,
    node_found_b2_o,
    node_found_angle_o,
    node_saturated_o,
    node_deviation_o,
    node_travel_o,
    node_glitches_o,
    node_phase_o,
    node_frequency_o,
    node_a_u_o,
    node_b_u_o,
    node_c_u_o,
    node_a_v_o,
    node_b_v_o,
    node_c_v_o,
    node_a1_o,
    node_a2_o,
    node_b1_o,
    node_b2_o,
    node_beta_o,
    node_phi_o,
    node_angle_o,
    node_error_average_o,
    node_status_o,
    node_flags_o,
    node_samples_o,
    node_turn_flags_o,
  input  logic [63:0]
    model_u_i,
    model_v_i,
    model_clip_i,
    model_s_high_i,
    model_s_low_i,
    model_c_high_i,
    model_c_low_i,
    model_mirror_i,
    model_cal_s_i,
    model_cal_c_i,
    model_det_i,
    model_saturated_t0_i,
    model_relative_i,
    model_amplitude_i,
    model_zero_i,
    model_unsettled_t1_i,
    model_saturated_t1_i,
    model_reference_phase_i,
    model_residue_i,
    model_sine_i,
    model_cosine_i,
    model_next_phase_i,
    model_next_frequency_i,
    model_turn_i,
    model_saturated_t2_i,
    model_error_u_i,
    model_error_v_i,
    model_next_a_u_i,
    model_next_b_u_i,
    model_next_c_u_i,
    model_next_a_v_i,
    model_next_b_v_i,
    model_next_c_v_i,
    model_next_average_i,
    model_saturated_t3_i,
    model_found_phi_i,
    model_found_a1_i,
    model_found_beta_i,
    model_found_a2_i,
    model_found_b1_i,
    model_found_b2_i,
    model_found_angle_i,
    model_saturated_i,
    model_deviation_i,
    model_travel_i,
    model_glitches_i,
    model_phase_i,
    model_frequency_i,
    model_a_u_i,
    model_b_u_i,
    model_c_u_i,
    model_a_v_i,
    model_b_v_i,
    model_c_v_i,
    model_a1_i,
    model_a2_i,
    model_b1_i,
    model_b2_i,
    model_beta_i,
    model_phi_i,
    model_angle_i,
    model_error_average_i,
    model_status_i,
    model_flags_i,
    model_samples_i,
    model_turn_flags_i
);

  logic        presetn, psel, penable, pwrite, sample_valid, sample_clip;
  logic [11:0] paddr;
  logic [31:0] pwdata, sample_u, sample_v;
  logic [3:0]  pstrb;
  always_ff @(posedge drive_i) begin
    presetn      <= presetn_i;
    psel         <= psel_i;
    penable      <= penable_i;
    pwrite       <= pwrite_i;
    paddr        <= paddr_i;
    pwdata       <= pwdata_i;
    pstrb        <= pstrb_i;
    sample_valid <= sample_valid_i;
    sample_u     <= sample_u_i;
    sample_v     <= sample_v_i;
    sample_clip  <= sample_clip_i;
  end

  coprocessor #(
    .Paper         (Paper),
    .OperandBits   (OperandBits),
    .ReferenceLead (ReferenceLead),
    .StepShift     (StepShift)
  ) dut (
    .pclk_i,
    .presetn_i      (presetn),
    .psel_i         (psel),
    .penable_i      (penable),
    .pwrite_i       (pwrite),
    .paddr_i        (paddr),
    .pwdata_i       (pwdata),
    .pstrb_i        (pstrb),
    .pready_o, .prdata_o, .pslverr_o,
    .sample_valid_i (sample_valid),
    .sample_u_i     (sample_u),
    .sample_v_i     (sample_v),
    .sample_clip_i  (sample_clip),
    .sample_ready_o, .irq_o, .idle_o
  );

  assign boundary_o     = dut.boundary;
  assign enter_o        = dut.enter;
  assign cycle_o        = dut.cycle;
  assign stage_o        = dut.stage;
  assign load_o         = dut.load;
  assign load_start_o   = dut.load_start;
  assign held_o         = dut.u_sequencer.held_q;
  assign load_pending_o = dut.u_sequencer.load_pending_q;
  assign running_o      = dut.u_sequencer.running;
  assign commit_o       = dut.commit & dut.boundary;

  assign phase_o = dut.phase;
  assign freq_o  = dut.freq;
  assign au_o    = dut.au;
  assign bu_o    = dut.bu;
  assign cu_o    = dut.cu;
  assign av_o    = dut.av;
  assign bv_o    = dut.bv;
  assign cv_o    = dut.cv;

  function automatic logic [63:0] s32(input logic [31:0] word);
    s32 = {{32{word[31]}}, word};
  endfunction

  function automatic logic [63:0] bit_of(input logic value);
    bit_of = {63'd0, value};
  endfunction

  function automatic logic [63:0] u32(input logic [31:0] word);
    u32 = {32'd0, word};
  endfunction

  function automatic logic [63:0] u48(input logic [47:0] word);
    u48 = {16'd0, word};
  endfunction

  function automatic logic [63:0] s48(input logic [47:0] word);
    s48 = {{16{word[47]}}, word};
  endfunction

  // Stage by stage. What a unit shows for one cycle only is kept from that cycle on.
  logic [4:0] ends;  // stages whose tick ends with this interval
  assign ends = dut.stage & {5{dut.boundary}};

  logic [66:0] s, c;
  logic [31:0] late_amplitude;
  if (Paper != 0) begin : g_paper
    assign late_amplitude = dut.u_datapath.g_paper.u_core.magnitude;
    assign s = {{35{node_cal_s_o[31]}}, node_cal_s_o[31:0]};
    assign c = {{35{node_cal_c_o[31]}}, node_cal_c_o[31:0]};
  end else begin : g_precise
    assign late_amplitude = '0;
    always_ff @(negedge pclk_i) begin
      if (dut.stage[0] && dut.cycle == 5'd14) begin
        s <= dut.u_datapath.g_precise.u_core.u_calibrator.x_q;
        c <= dut.u_datapath.g_precise.u_core.u_calibrator.y_q;
      end
    end
  end
  assign node_s_high_o = {{61{s[66]}}, s[66:64]};
  assign node_s_low_o  = s[63:0];
  assign node_c_high_o = {{61{c[66]}}, c[66:64]};
  assign node_c_low_o  = c[63:0];

  always_ff @(negedge pclk_i) begin
    if (dut.u_datapath.calibrated_valid && dut.u_datapath.calibrated_s)
      node_cal_s_o <= s32(dut.u_datapath.calibrated);
    if (dut.u_datapath.calibrated_valid && !dut.u_datapath.calibrated_s)
      node_cal_c_o <= s32(dut.u_datapath.calibrated);
    if (ends[0]) begin
      node_clip_o         <= bit_of(dut.u_datapath.u_sample_tags.clip_q[0]);
      node_u_o            <= s32(dut.u_datapath.u_q);
      node_v_o            <= s32(dut.u_datapath.v_q);
      node_mirror_o       <= bit_of(dut.u_datapath.mirror);
      node_saturated_t0_o <= bit_of(dut.u_datapath.u_sample_tags.saturated_q[0] |
                                    dut.u_datapath.u_sample_tags.saturated_i[0]);
    end

    if (dut.u_datapath.det_valid) node_det_o <= s32(dut.u_datapath.det);
    if (Paper == 0 && dut.u_datapath.amplitude_valid) node_amplitude_o <= s32(dut.u_datapath.amplitude);
    if (ends[1]) begin
      node_relative_o     <= u32(dut.u_datapath.relative);
      node_zero_o         <= bit_of(dut.u_datapath.zero);
      node_unsettled_t1_o <= bit_of(dut.u_datapath.unsettled1);
      if (Paper != 0) node_amplitude_o <= s32(late_amplitude);
      node_saturated_t1_o <= bit_of(dut.u_datapath.u_sample_tags.saturated_q[1] |
                                    dut.u_datapath.u_sample_tags.saturated_i[1]);
    end

    if (dut.stage[2] && dut.cycle == 5'd0) node_residue_o <= s32(dut.u_datapath.residue);
    if (ends[2]) begin
      node_reference_phase_o <= u32(dut.u_datapath.reference_phase);
      node_turn_o            <= bit_of(dut.u_datapath.turn);
      node_sine_o            <= s32(dut.u_datapath.u_reference_generator.sine);
      node_cosine_o          <= s32(dut.u_datapath.u_reference_generator.cosine);
      node_next_phase_o      <= u48(dut.phase_next);
      node_next_frequency_o  <= dut.freq_we ? s48(dut.freq_next) : '0;
      node_saturated_t2_o    <= bit_of(dut.u_datapath.u_sample_tags.saturated_q[2] |
                                       dut.u_datapath.u_sample_tags.saturated_i[2]);
    end

    if (dut.u_datapath.error_valid && !dut.u_datapath.error_v)
      node_error_u_o <= s32(dut.u_datapath.error);
    if (dut.u_datapath.error_valid && dut.u_datapath.error_v)
      node_error_v_o <= s32(dut.u_datapath.error);
    if (ends[3]) begin
      node_next_a_u_o     <= dut.weights_u_we ? s48(dut.au_next) : '0;
      node_next_b_u_o     <= dut.weights_u_we ? s48(dut.bu_next) : '0;
      node_next_c_u_o     <= dut.weights_u_we ? s48(dut.cu_next) : '0;
      node_next_a_v_o     <= dut.weights_v_we ? s48(dut.av_next) : '0;
      node_next_b_v_o     <= dut.weights_v_we ? s48(dut.bv_next) : '0;
      node_next_c_v_o     <= dut.weights_v_we ? s48(dut.cv_next) : '0;
      node_next_average_o <= u32(dut.u_datapath.average);
      node_saturated_t3_o <= bit_of(dut.u_datapath.u_sample_tags.saturated_q[3] |
                                    dut.u_datapath.u_sample_tags.saturated_i[3]);
    end

    if (dut.stage[4] && dut.cycle == 5'd13) node_deviation_o <= u32(dut.u_datapath.u_turn_judge.sum[31:0]);
    if (ends[4]) begin
      node_found_phi_o   <= u32(dut.phi_next);
      node_found_a1_o    <= s32(dut.a1_next);
      node_found_beta_o  <= u32(dut.beta_next);
      node_found_a2_o    <= s32(dut.a2_next);
      node_found_b1_o    <= s32(dut.b1_next);
      node_found_b2_o    <= s32(dut.b2_next);
      node_found_angle_o <= u32(dut.u_datapath.angle);
      node_saturated_o   <= bit_of(dut.flag_sat);
      node_travel_o      <= s32(dut.u_datapath.u_turn_judge.sum[31:0]);
      node_glitches_o    <= {59'd0, dut.u_datapath.u_turn_judge.glitches};
      // Registers as this edge leaves them, if software does not write them at it.
      node_phase_o         <= u48(dut.phase_we ? dut.phase_next : dut.phase);
      node_frequency_o     <= s48(dut.freq_we ? dut.freq_next : dut.freq);
      node_a_u_o           <= s48(dut.weights_u_we ? dut.au_next : dut.au);
      node_b_u_o           <= s48(dut.weights_u_we ? dut.bu_next : dut.bu);
      node_c_u_o           <= s48(dut.weights_u_we ? dut.cu_next : dut.cu);
      node_a_v_o           <= s48(dut.weights_v_we ? dut.av_next : dut.av);
      node_b_v_o           <= s48(dut.weights_v_we ? dut.bv_next : dut.bv);
      node_c_v_o           <= s48(dut.weights_v_we ? dut.cv_next : dut.cv);
      node_a1_o            <= s32(dut.parameters_we ? dut.a1_next : dut.a1);
      node_a2_o            <= s32(dut.parameters_we ? dut.a2_next : dut.a2);
      node_b1_o            <= s32(dut.parameters_we ? dut.b1_next : dut.b1);
      node_b2_o            <= s32(dut.parameters_we ? dut.b2_next : dut.b2);
      node_beta_o          <= u32(dut.parameters_we ? dut.beta_next : dut.beta);
      node_phi_o           <= u32(dut.parameters_we ? dut.phi_next : dut.phi);
      node_angle_o         <= dut.u_datapath.valid     ? u32(dut.u_datapath.angle) :
                              dut.u_datapath.angle_any ? u32(dut.u_datapath.angle_q) : '0;
      node_error_average_o <= node_next_average_o;  // still of the sample in T4
      node_status_o        <= {50'd0, dut.u_datapath.u_turn_judge.good_turns, 3'd0, Paper != 0, 1'b0,
                               dut.frozen, dut.flag_alarm, dut.u_datapath.valid,
                               dut.u_datapath.u_sample_tags.mirror_q[3],
                               dut.u_datapath.u_sample_tags.diverged4_q,
                               dut.u_datapath.u_sample_tags.lock, 1'b1};
      node_flags_o         <= {52'd0, dut.u_register_bank.flags |
                               {dut.flag_unsettled, dut.flag_alarm, dut.flag_turn, 1'b0, dut.flag_mirrorchg, dut.flag_diverged, dut.flag_lockchg, 1'b0,
                                dut.flag_zero, dut.flag_sat, dut.flag_clip, 1'b1}};
      node_samples_o       <= u32(dut.u_register_bank.samples + 32'd1);
      node_turn_flags_o    <= u32(dut.flag_turn ?
          {dut.turn_flags[31:24] + 8'd1, 1'b0, dut.u_datapath.u_turn_judge.flags} : dut.turn_flags);
    end
  end

endmodule
