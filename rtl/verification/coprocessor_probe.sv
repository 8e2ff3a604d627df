// SPDX-License-Identifier: Apache-2.0
// Verification wrapper of the coprocessor: the design as `dut`, and inside values as ports, taken by
// hierarchical reference. Not part of the design.
//
// models/coprocessor/nodes.def lists the nodes; scripts/capsoc_tools/generate/nodes.py makes their ports and processes. A node is captured at the
// falling edge in the middle of the interval in which it is valid; node_NAME_o then holds it to the end of the tick at the least.
// Inputs are taken over at the rising edge of drive_i, which costs the simulator less than inputs that
// might change at any time: nothing after them is evaluated while they rest.
// The model_NAME_i inputs go nowhere: they put the model's nodes into the same wave file.
// Signed words are sign-extended to 64 bits, others zero-extended.
module coprocessor_probe #(
  parameter int Paper         = 0,
  parameter int OperandBits   = 32,
  parameter int ReferenceLead = 0,
  parameter int StepShift     = 0,
  parameter int IterationClocks = 1,
  parameter int Channels      = 1
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
  input  logic [3:0]  sample_channel_i,
  output logic        sample_ready_o,
  output logic        irq_o,
  output logic        idle_o,
  // Sequencer
  output logic        boundary_o,
  output logic        enter_o,
  output logic [5:0]  cycle_o,  // of the tick's clocks
  output logic [4:0]  stage_o,
  output logic [2:0]  load_o,
  output logic [2:0]  load_start_o,
  output logic        held_o,
  output logic        load_pending_o,
  output logic        running_o,
  output logic        commit_o,
  // Channels: the active one, CHANNEL.READY, the held sample may not enter, edges to the beginning or the end of a change
  output logic [3:0]  active_o,
  output logic        ready_o,
  output logic        blocked_o,
  output logic [5:0]  change_o,
  // 48-bit registers
  output logic [47:0] phase_o, freq_o, au_o, bu_o, cu_o, av_o, bv_o, cv_o,
  // Nodes, RTL and model
`include "coprocessor_node_ports.svh"
);

  logic        presetn, psel, penable, pwrite, sample_valid, sample_clip;
  logic [11:0] paddr;
  logic [31:0] pwdata, sample_u, sample_v;
  logic [3:0]  pstrb, sample_channel;
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
    sample_channel <= sample_channel_i;
  end

  coprocessor #(
    .Paper         (Paper),
    .OperandBits   (OperandBits),
    .ReferenceLead (ReferenceLead),
    .StepShift     (StepShift),
    .IterationClocks(IterationClocks),
    .Channels      (Channels)
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
    .sample_channel_i (sample_channel),
    .sample_ready_o, .irq_o, .idle_o
  );

  assign boundary_o     = dut.u_sequencer.boundary;
  assign enter_o        = dut.u_sequencer.enter;
  assign cycle_o        = 6'(dut.u_sequencer.cycle_q);
  assign stage_o        = dut.u_sequencer.stage_q;
  assign load_o         = dut.u_sequencer.load_q;
  assign load_start_o   = dut.u_sequencer.load_start;
  assign held_o         = dut.u_sequencer.held_q;
  assign load_pending_o = dut.u_sequencer.load_pending_q;
  assign running_o      = dut.u_sequencer.running;
  assign commit_o       = dut.commit & boundary_o;

  if (Channels > 1) begin : g_channels
    assign active_o  = dut.g_channels.u_channel_control.active_q;
    assign ready_o   = dut.ready;
    assign blocked_o = dut.blocked;
    assign change_o  = dut.g_channels.u_channel_control.changing_q ? 6'd32 - {1'b0, dut.g_channels.u_channel_control.index_q} :
                       {5'd0, dut.g_channels.u_channel_control.begins};
  end else begin : g_one_channel
    assign {active_o, ready_o, blocked_o, change_o} = {4'd0, 1'b1, 7'd0};
  end

  assign phase_o = dut.u_register_bank.u_state.u_phase.value_q;
  assign freq_o  = dut.u_register_bank.u_state.u_freq.value_q;
  assign au_o    = dut.u_register_bank.u_state.u_au.value_q;
  assign bu_o    = dut.u_register_bank.u_state.u_bu.value_q;
  assign cu_o    = dut.u_register_bank.u_state.u_cu.value_q;
  assign av_o    = dut.u_register_bank.u_state.u_av.value_q;
  assign bv_o    = dut.u_register_bank.u_state.u_bv.value_q;
  assign cv_o    = dut.u_register_bank.u_state.u_cv.value_q;

  // Stage by stage. What a unit shows for one cycle only is kept from that cycle on.
  logic [4:0] ends;  // stages whose tick ends with this interval
  assign ends = stage_o & {5{boundary_o}};

  logic [66:0] s, c;
  logic [31:0] late_amplitude;
  if (Paper != 0) begin : g_paper
    assign late_amplitude = dut.u_datapath.g_paper.u_core.magnitude;
    assign s = {{35{node_cal_s_o[31]}}, node_cal_s_o[31:0]};
    assign c = {{35{node_cal_c_o[31]}}, node_cal_c_o[31:0]};
  end else begin : g_precise
    assign late_amplitude = '0;
    always_ff @(negedge pclk_i) begin
      if (stage_o[0] && cycle_o == 6'd14) begin
        s <= dut.u_datapath.g_precise.u_core.u_calibrator.x_q;
        c <= dut.u_datapath.g_precise.u_core.u_calibrator.y_q;
      end
    end
  end

  // T3 writes coefficients or sums.
  logic learns;
  assign learns = dut.u_datapath.u_block_learning.update_q | dut.u_datapath.u_block_learning.sum_q;

  function automatic logic saturated(input logic [2:0] index);
    saturated = dut.u_datapath.u_sample_tags.saturated_q[index] | dut.u_datapath.u_sample_tags.saturated_i[index];
  endfunction

  // STATUS, FLAGS and TURN_FLAGS as the commit leaves them, if software does not write them at that edge.
  function automatic logic [31:0] next_status();
    next_status = {18'd0, dut.u_datapath.u_turn_judge.good_turns, 3'd0, Paper != 0, 1'b0,
                   dut.frozen, dut.u_datapath.u_turn_judge.alarm_next_o, dut.u_datapath.valid,
                   dut.u_datapath.u_sample_tags.mirror_q[3],
                   dut.u_datapath.u_sample_tags.diverged4_q,
                   dut.u_datapath.u_sample_tags.lock, 1'b1};
  endfunction

  // EARLY and CONFIG are not a commit's.
  localparam logic [15:0] Others = 16'd1 << capsoc_coprocessor_pkg::FLAGS_EARLY_LSB |
                                   16'd1 << capsoc_coprocessor_pkg::FLAGS_CONFIG_LSB;
  function automatic logic [31:0] next_flags();
    next_flags = {16'd0, dut.u_register_bank.flags | (dut.u_register_bank.events & ~Others)};
  endfunction

  function automatic logic [31:0] next_turn_flags();
    next_turn_flags = dut.u_datapath.u_turn_judge.ended_o ? {dut.turn_flags[31:24] + 8'd1, dut.u_datapath.u_turn_judge.flags}
                                    : dut.turn_flags;
  endfunction

`include "coprocessor_node_captures.svh"

endmodule
