// SPDX-License-Identifier: Apache-2.0
// Polar unit: angle and magnitude of three vectors a tick, T1's (S, C) and T4's (-a_v, b_v) and
// (b_u, a_u). It stands in for the paper's square root (Eq (10)) and PI arctangent (Eq (11)).
//
//   s_i, c_i, shift_i, zero_i    T1's vector as the calibrator leaves it, taken at the boundary
//   weight*_i                    s48, Q2.46: places of the weight ring
//   relative_o                   u32, 2^-32 turn; zero_o: no angle; valid in cycle 31 (from 11 on)
//   amplitude_o                  s32, Q1.31, valid with amplitude_valid_o in cycle 11
//   a1_o, a2_o                   s32, Q1.31; phi_o, psi_o: u32, 2^-32 turn; valid in cycle 31
//
// One vectoring CORDIC of 30 stages and 5 guard bits, shifts rounded half up, makes three
// micro-rotations a cycle: T1 in cycles 0 to 9, psi in 10 to 19, phi in 20 to 29. The input is the
// normalised vector, >>r to 35 bits in addition to the sign, negated if x < 0 (then z begins at half a
// turn).
module polar_unit (
  input  logic               clk_i,
  input  logic               boundary_i,
  input  logic               t1_active_i,  // T1 holds a sample
  input  logic               t4_active_i,  // T4 holds a sample
  input  logic        [ 4:0] cycle_i,
  input  logic        [36:0] s_i,
  input  logic        [36:0] c_i,
  input  logic        [ 6:0] shift_i,
  input  logic               zero_i,
  input  logic        [47:0] weight3_i,
  input  logic        [47:0] weight4_i,
  input  logic        [47:0] weight5_i,
  output logic        [31:0] relative_o,
  output logic               zero_o,
  output logic               amplitude_valid_o,
  output logic        [31:0] amplitude_o,
  output logic        [31:0] a1_o,
  output logic        [31:0] a2_o,
  output logic        [31:0] phi_o,
  output logic        [31:0] psi_o,
  output logic               t1_saturated_o,
  output logic               t4_saturated_o
);

  logic [36:0] x_normal, y_normal;
  logic [6:0] shift_normal;
  logic zero_normal;
  polar_normaliser u_normaliser (
    .clk_i,
    .active_i (t4_active_i),
    .cycle_i,
    .weight3_i,
    .weight4_i,
    .weight5_i,
    .x_o      (x_normal),
    .y_o      (y_normal),
    .shift_o  (shift_normal),
    .zero_o   (zero_normal)
  );

  // The word's last bit is the one that rounds it. -(q + r) = ~q + ~r. A small negative x is
  // rounded to zero, which is not negative.
  logic [36:0] x_word, y_word;
  logic negate;
  logic signed [38:0] x_load, y_load;
  assign x_word = boundary_i ? c_i : x_normal;
  assign y_word = boundary_i ? s_i : y_normal;
  assign negate = x_word[36] && !(&x_word[35:0]);
  assign x_load = 39'($signed(x_word[36:1] ^ {36{negate}})) + $signed({38'b0, x_word[0] ^ negate});
  assign y_load = 39'($signed(y_word[36:1] ^ {36{negate}})) + $signed({38'b0, y_word[0] ^ negate});

  logic signed [38:0] x_q, y_q, x1, y1, x2, y2, x3, y3;
  logic [36:0] z_q, z1, z2, z3;
  logic [1:0] thirds_q, rest_q;  // of the number of the cycle, 0 to 9
  vectoring_step #(.Offset(0)) u_step0 (
    .thirds_i(thirds_q), .rest_i(rest_q), .x_i(x_q), .y_i(y_q), .z_i(z_q), .x_o(x1), .y_o(y1), .z_o(z1));
  vectoring_step #(.Offset(1)) u_step1 (
    .thirds_i(thirds_q), .rest_i(rest_q), .x_i(x1), .y_i(y1), .z_i(z1), .x_o(x2), .y_o(y2), .z_o(z2));
  vectoring_step #(.Offset(2)) u_step2 (
    .thirds_i(thirds_q), .rest_i(rest_q), .x_i(x2), .y_i(y2), .z_i(z2), .x_o(x3), .y_o(y3), .z_o(z3));

  // It rests where no result of it is used: without a sample in T1 or T4, and after T1's amplitude.
  logic active, last, load;
  assign active = (t1_active_i && !cycle_i[4]) || t4_active_i;
  assign last = cycle_i == 5'd9 || cycle_i == 5'd19 || cycle_i == 5'd29;
  assign load = boundary_i || (active && last);

  // A vector's shift and zero flag follow it: as long as it is in the CORDIC, and after it.
  logic [6:0] shift_q, shift_out_q;
  logic zero_q, zero_out_q;
  logic signed [38:0] x_out_q;
  logic [32:0] z_out_q;
  // No reset: each is loaded before a stage reads it.
  always_ff @(posedge clk_i) begin
    if (load) begin
      x_q <= x_load;
      y_q <= y_load;
      z_q <= {negate, 36'b0};
      {thirds_q, rest_q} <= '0;
      shift_q <= boundary_i ? shift_i : shift_normal;
      zero_q <= boundary_i ? zero_i : zero_normal;
    end else if (active) begin
      x_q <= x3;
      y_q <= y3;
      z_q <= z3;
      thirds_q <= thirds_q + {1'b0, rest_q[1]};
      rest_q <= {rest_q[0], ~|rest_q};
    end
    if (active && last) begin
      x_out_q <= x3;
      z_out_q <= z3[36:4];
      shift_out_q <= shift_q;
      zero_out_q <= zero_q;
    end
  end

  logic [31:0] angle;
  assign angle = zero_out_q ? '0 : z_out_q[32:1] + 32'(z_out_q[0]);

  logic [31:0] magnitude;
  logic over;
  vector_gain u_gain (
    .clk_i,
    .active_i   (active),
    .x_i        (x_out_q),
    .shift_i    (shift_out_q),
    .magnitude_o(magnitude),
    .saturated_o(over)
  );

  logic [31:0] relative_q, psi_q, a2_q;
  logic t1_zero_q;
  always_ff @(posedge clk_i) begin
    if (t1_active_i && cycle_i == 5'd10) begin
      relative_q <= angle;
      t1_zero_q <= zero_out_q;
    end
    if (t4_active_i && cycle_i == 5'd20) psi_q <= angle;
    if (t4_active_i && cycle_i == 5'd21) a2_q <= magnitude;
  end

  assign relative_o = relative_q;
  assign zero_o = t1_zero_q;
  assign amplitude_valid_o = t1_active_i && cycle_i == 5'd11;
  assign amplitude_o = magnitude;
  assign a1_o = magnitude;
  assign a2_o = a2_q;
  assign phi_o = angle;
  assign psi_o = psi_q;
  assign t1_saturated_o = amplitude_valid_o && over;
  assign t4_saturated_o = t4_active_i && (cycle_i == 5'd21 || cycle_i == 5'd31) && over;

  logic unused_z;
  assign unused_z = ^z3[3:0];

endmodule
