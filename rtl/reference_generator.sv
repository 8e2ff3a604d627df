// SPDX-License-Identifier: Apache-2.0
// Reference generator, stage T2: phase accumulator, choice of the reference, rotation CORDIC.
//
//   phase, freq         u48 and s48, 2^-48 turn; registers of the bank, copied at the tick's start
//   relative_i          u32, 2^-32 turn: T1's angle, valid at the boundary that starts T2
//   reference_phase_o   u32, 2^-32 turn, phase >>r 16; stable in T2's tick
//   residue_o           s32, 2^-32 turn, relative - reference phase; valid in cycle 0
//   turn_o              PHASE + FREQ leaves the turn, not with the tracking source; valid in cycle 31
//   sine_o, cosine_o    s32, Q1.31; registered at T2's end (or L0's, L1's), stable in T3's tick
//
// PHASE' = PHASE + FREQ + (residue << 16) >>r KP and FREQ' = sat(FREQ + (residue << 16) >>r KI),
// the second terms with the tracking source only. The residue is shifted by one place a cycle: in
// cycle n it stands at n places, so each sum is taken in the cycle of its own shift, up to 31.
module reference_generator #(
  parameter int Paper = 0,
  parameter int ReferenceLead = 0
) (
  input  logic               clk_i,
  input  logic               rst_ni,
  input  logic               boundary_i,
  input  logic        [ 4:0] cycle_i,
  input  logic               start_i,       // a sample enters T2 at this boundary
  input  logic               active_i,      // T2 holds a sample
  input  logic               load_start_i,  // L0 or L1 begins at this boundary
  input  logic               load_active_i,
  input  logic        [31:0] load_phase_i,  // 2^-32 turn
  input  logic        [ 1:0] ref_i,
  input  logic        [ 4:0] kp_i,
  input  logic        [ 4:0] ki_i,
  input  logic        [47:0] phase_i,
  input  logic        [47:0] freq_i,
  input  logic        [31:0] relative_i,
  input  logic               zero_i,
  output logic               phase_we_o,
  output logic        [47:0] phase_o,
  output logic               freq_we_o,
  output logic        [47:0] freq_o,
  output logic               saturated_o,
  output logic               hold_weights_o,  // angle source without an angle; stable in the tick
  output logic               turn_o,
  output logic        [31:0] reference_phase_o,
  output logic        [31:0] residue_o,
  output logic signed [31:0] sine_o,
  output logic signed [31:0] cosine_o
);

  localparam logic [1:0] RefTracking = 2'd1;
  localparam logic [1:0] RefAngle = 2'd2;

  logic [47:0] phase_q, freq_q, steer_q;
  logic [31:0] reference_phase_q;
  logic steer_round_q, tracking_q, hold_q, wait_q;
  logic [4:0] kp_q, ki_q;
  logic signed [31:0] sine_q, cosine_q;

  // What PHASE and FREQ are for a tick that starts now: what the tick that ends writes comes first.
  logic [47:0] phase_now, freq_now;
  assign phase_now = phase_we_o ? phase_o : phase_i;
  assign freq_now = freq_we_o ? freq_o : freq_i;

  logic angle_source;
  logic [47:0] reference;
  logic [31:0] reference_phase, residue;
  assign angle_source = ref_i == RefAngle;
  assign reference = angle_source ? {relative_i, 16'b0} : phase_now;
  assign reference_phase = reference[47:16] + 32'(reference[15]);
  assign residue = zero_i ? '0 : relative_i - reference_phase;

  // One adder for FREQ and the residue: FREQ comes in cycle 0, or in cycle 1 if KP = 0 has the residue
  // in cycle 0; always before FREQ changes. KP = KI = 0 would change it first: then the residue waits
  // for a cycle, and both sums come in cycle 1.
  logic no_shift;
  assign no_shift = kp_i == '0 && ki_i == '0;

  logic hit_phase, hit_freq;
  logic add_freq;
  logic [49:0] phase_sum;
  logic turn_q;
  logic [49:0] freq_sum;
  logic freq_over;
  assign hit_phase = active_i && tracking_q && cycle_i == kp_q;
  assign hit_freq = active_i && tracking_q && cycle_i == ki_q;
  assign add_freq = cycle_i == {4'b0, kp_q == '0};
`ifdef VERILATOR
  always_ff @(posedge clk_i) begin
    assert (!(add_freq && hit_phase)) else $error("FREQ and the residue meet in the adder in cycle %0d", cycle_i);
    assert (!(hit_freq && cycle_i < {4'b0, kp_q == '0})) else $error("FREQ changes before it is added");
  end
`endif
  // The rounding bit comes in as a carry: {a, 1} + {b, carry}.
  assign phase_sum = {1'b0, phase_q, 1'b1} + {1'b0, add_freq  ? {freq_q, 1'b0} :
                                                    hit_phase ? {steer_q, steer_round_q} : '0};
  assign freq_sum = {freq_q[47], freq_q, 1'b1} +
      (hit_freq ? {steer_q[47], steer_q, steer_round_q} : '0);
  assign freq_over = freq_sum[49] != freq_sum[48];
  assign phase_o = phase_sum[48:1];
  assign freq_o = freq_over ? {freq_sum[49], {47{~freq_sum[49]}}} : freq_sum[48:1];
  assign phase_we_o = active_i && boundary_i;
  assign freq_we_o = active_i && boundary_i && tracking_q;
  assign saturated_o = hit_freq && freq_over;

  // No reset on the data: a boundary loads them before a stage reads them.
  always_ff @(posedge clk_i) begin
    if (start_i && boundary_i) begin
      phase_q <= phase_now;
      freq_q <= freq_now;
      steer_q <= {residue, 16'b0};
      steer_round_q <= 1'b0;
      reference_phase_q <= reference_phase;
    end else if (active_i) begin
      phase_q <= phase_o;
      freq_q <= freq_o;
      // A step forward leaves the turn with a carry, one backward without.
      if (add_freq) turn_q <= (phase_sum[49] ^ freq_q[47]) && !tracking_q;
      if (!(wait_q && cycle_i == '0)) begin
        steer_q <= {steer_q[47], steer_q[47:1]};
        steer_round_q <= steer_q[0];
      end
    end
    if (boundary_i && (active_i || load_active_i)) begin
      sine_q <= sine;
      cosine_q <= cosine;
    end
  end

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      tracking_q <= 1'b0;
      hold_q <= 1'b0;
      wait_q <= 1'b0;
      kp_q <= '0;
      ki_q <= '0;
    end else if (start_i && boundary_i) begin
      tracking_q <= ref_i == RefTracking;
      hold_q <= angle_source && zero_i;
      wait_q <= no_shift;
      kp_q <= kp_i | {4'b0, no_shift};
      ki_q <= ki_i | {4'b0, no_shift};
    end
  end

  // Table 8's phi comes from a reference that leads its data; the option repeats it.
  logic [47:0] lead;
  if (Paper != 0 && ReferenceLead != 0) begin : g_lead
    localparam logic [47:0] Lead = 48'(ReferenceLead);
    assign lead = angle_source ? '0 : 48'(Lead * freq_now);
  end else begin : g_no_lead
    assign lead = '0;
  end

  logic signed [31:0] sine, cosine;
  rotation_cordic #(
    .Paper(Paper)
  ) u_rotation_cordic (
    .clk_i,
    .start_i (boundary_i && (start_i || load_start_i)),
    .run_i   (active_i || load_active_i),
    .step_i  (cycle_i),
    .phase_i (load_start_i ? {load_phase_i, 16'b0} : reference + lead),
    .sine_o  (sine),
    .cosine_o(cosine)
  );

  assign hold_weights_o = hold_q;
  assign reference_phase_o = reference_phase_q;
  assign turn_o = turn_q;
  assign residue_o = steer_q[47:16];
  assign sine_o = sine_q;
  assign cosine_o = cosine_q;

  logic unused_sum;
  assign unused_sum = phase_sum[0] ^ freq_sum[0];

endmodule
