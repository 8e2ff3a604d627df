// SPDX-License-Identifier: Apache-2.0
// Parameters from coefficients in the paper arithmetic, Eq (9): two amplitudes by square root,
// two angles by arctangent. phi = angle of (b_u, a_u); psi = angle of (-a_v, b_v); beta = psi - phi.
//
// Latency: one tick; outputs valid in cycle 31. Inputs stable in the whole tick. State changes only
// if run_i.
//
// au_i .. bv_i   s48, Q2.46, of which this arithmetic has bits 46:15 (Q1.31)
// a1_o, a2_o     s32, Q1.31
// beta_o, phi_o  u32, 2^-32 turn, wrap
// settled_o      both arctangents have converged
// saturated_o    a sum of squares was 1 or more, or -a_v was clamped
//
// Rounding: see paper_square_root and paper_arctangent.
module paper_parameters #(
  parameter int OperandBits = 32,
  parameter int Plain = 0,
  parameter int IterationClocks = 1
) (
  input  logic               clk_i,
  input  logic               rst_ni,
  input  logic               run_i,
  input  logic         [5:0] clock_i,  // of the tick
  input  logic         [4:0] cycle_i,
  input  logic               rest_i,   // the square roots wait
  input  logic signed [47:0] au_i,
  input  logic signed [47:0] bu_i,
  input  logic signed [47:0] av_i,
  input  logic signed [47:0] bv_i,
  output logic signed [31:0] a1_o,
  output logic signed [31:0] a2_o,
  output logic        [31:0] beta_o,
  output logic        [31:0] phi_o,
  output logic               settled_o,
  output logic               saturated_o
);

  logic signed [31:0] av, minus_av;
  logic saturated_av, saturated_a1, saturated_a2;
  assign av = av_i[46:15];
  assign saturated_av = (av == 32'h8000_0000);
  assign minus_av = saturated_av ? 32'h7fff_ffff : -av;

  paper_square_root u_a1 (
    .clk_i,
    .rst_ni,
    .run_i(run_i && !rest_i),
    .cycle_i,
    .a_i(au_i[46:15]),
    .b_i(bu_i[46:15]),
    .amplitude_o(a1_o),
    .saturated_o(saturated_a1)
  );

  paper_square_root u_a2 (
    .clk_i,
    .rst_ni,
    .run_i(run_i && !rest_i),
    .cycle_i,
    .a_i(av),
    .b_i(bv_i[46:15]),
    .amplitude_o(a2_o),
    .saturated_o(saturated_a2)
  );

  logic phi_settled, psi_settled;
  logic [31:0] unused_phi_magnitude, unused_psi_magnitude;
  paper_arctangent #(
    .OperandBits(OperandBits),
    .Plain(Plain),
    .IterationClocks(IterationClocks)
  ) u_phi (
    .clk_i,
    .rst_ni,
    .run_i,
    .clock_i,
    .y_i(bu_i[46:15]),
    .x_i(au_i[46:15]),
    .angle_o(phi_o),
    .magnitude_o(unused_phi_magnitude),
    .settled_o(phi_settled)
  );

  logic [31:0] psi;
  paper_arctangent #(
    .OperandBits(OperandBits),
    .Plain(Plain),
    .IterationClocks(IterationClocks)
  ) u_psi (
    .clk_i,
    .rst_ni,
    .run_i,
    .clock_i,
    .y_i(minus_av),
    .x_i(bv_i[46:15]),
    .angle_o(psi),
    .magnitude_o(unused_psi_magnitude),
    .settled_o(psi_settled)
  );

  assign beta_o = psi - phi_o;
  assign settled_o = phi_settled && psi_settled;
  assign saturated_o = saturated_a1 || saturated_a2 || saturated_av;

  logic unused_bits;
  assign unused_bits = ^{au_i[47], au_i[14:0], bu_i[47], bu_i[14:0], av_i[47], av_i[14:0],
                         bv_i[47], bv_i[14:0]};

endmodule
