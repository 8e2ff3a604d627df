// SPDX-License-Identifier: Apache-2.0
// Rotation CORDIC: sine and cosine of a phase, one micro-rotation a cycle (section 3.3 of the
// paper).
//
//   phase_i           u48, 2^-48 turn, taken at the edge with start_i
//   sine_o, cosine_o  s32, Q1.31, full scale 2^31 - 1, clamped
//
// Paper = 0: 30 stages, x and y s38 with 5 guard bits, z s37 in 2^-37 turn (phase rounded half up),
//   every shift rounded half up.
// Paper = 1: 28 stages, x and y s33, z s32 in 2^-32 turn (phase truncated), every shift truncated.
// Latency: the result is valid 30 (28) cycles with run_i after start_i, until the next start_i.
// step_i is the number of the micro-rotation; steps past the last one change nothing.
module rotation_cordic #(
  parameter int Paper = 0
) (
  input  logic               clk_i,
  input  logic               start_i,
  input  logic               run_i,
  input  logic        [ 4:0] step_i,
  input  logic        [47:0] phase_i,
  output logic signed [31:0] sine_o,
  output logic signed [31:0] cosine_o
);

  localparam int Stages = Paper != 0 ? 28 : 30;
  localparam int Width = Paper != 0 ? 33 : 38;
  localparam int ZWidth = Paper != 0 ? 32 : 37;

  // No reset: start_i loads all three before anything reads them.
  logic signed [Width-1:0] x_q, y_q;
  logic signed [ZWidth-1:0] z_q;

  logic [ZWidth-1:0] angle;
  logic [Width-1:0] gain;
  logic [Stages*ZWidth-1:0] table_word;
  if (Paper != 0) begin : g_paper
    assign angle = phase_i[47:16];
    assign gain = cordic_pkg::START_33;
    assign table_word = cordic_pkg::ANGLE_32;
    logic [15:0] unused_phase;
    assign unused_phase = phase_i[15:0];
  end else begin : g_precise
    assign angle = phase_i[47:11] + 37'(phase_i[10]);
    assign gain = cordic_pkg::START_38;
    assign table_word = cordic_pkg::ANGLE_37;
    logic [9:0] unused_phase;
    assign unused_phase = phase_i[9:0];
  end

  // The CORDIC reaches +-99 degrees: outside [-quarter, quarter) it starts half a turn on, from -x0.
  logic outside;
  assign outside = angle[ZWidth-1] ^ angle[ZWidth-2];

  logic [ZWidth-1:0] rom;
  always_comb begin
    rom = '0;
    for (int i = 0; i < Stages; i++)
      rom |= step_i == 5'(i) ? table_word[ZWidth*i +: ZWidth] : '0;
  end

  // One more bit below, which is the one that the rounding looks at.
  logic signed [38:0] x_fine, y_fine, x_shifted, y_shifted;
  shift_multiplier u_shift_x (
    .data_i  (39'($signed({x_q, 1'b0}))),
    .places_i(step_i[3:0]),
    .data_o  (x_fine)
  );
  shift_multiplier u_shift_y (
    .data_i  (39'($signed({y_q, 1'b0}))),
    .places_i(step_i[3:0]),
    .data_o  (y_fine)
  );
  assign x_shifted = step_i[4] ? x_fine >>> 16 : x_fine;
  assign y_shifted = step_i[4] ? y_fine >>> 16 : y_fine;
  // d = -1 where z < 0. +b or -b with its rounding bit r is (b ^ {s}) + (s ^ r).
  logic minus, x_carry, y_carry;
  logic [Width-1:0] x_sum, y_sum;
  logic [ZWidth-1:0] z_sum;
  assign minus = z_q[ZWidth-1];
  assign x_carry = ~minus ^ (Paper == 0 && y_shifted[0]);
  assign y_carry = minus ^ (Paper == 0 && x_shifted[0]);
  add_subtract #(.Width(Width)) u_x (
    .a_i(x_q), .b_i(y_shifted[Width:1]), .minus_i(~minus),
    .carry_i(x_carry), .sum_o(x_sum)
  );
  add_subtract #(.Width(Width)) u_y (
    .a_i(y_q), .b_i(x_shifted[Width:1]), .minus_i(minus),
    .carry_i(y_carry), .sum_o(y_sum)
  );
  add_subtract #(.Width(ZWidth)) u_z (
    .a_i(z_q), .b_i(rom), .minus_i(~minus), .carry_i(~minus), .sum_o(z_sum)
  );

  always_ff @(posedge clk_i) begin
    if (start_i) begin
      x_q <= outside ? $signed(-gain) : $signed(gain);
      y_q <= '0;
      z_q <= $signed({angle[ZWidth-2], angle[ZWidth-2:0]});
    end else if (run_i && step_i < 5'(Stages)) begin
      x_q <= $signed(x_sum);
      y_q <= $signed(y_sum);
      z_q <= $signed(z_sum);
    end
  end

  // The clamp belongs to the format: the CORDIC's own error reaches past full scale.
  logic signed [32:0] sine, cosine;
  if (Paper != 0) begin : g_paper_out
    assign sine = y_q;
    assign cosine = x_q;
  end else begin : g_precise_out
    // x and y stay below 2^36, so the rounded words fit 33 bits.
    assign sine = $signed(y_q[Width-1:Width-33]) + $signed({32'b0, y_q[4]});
    assign cosine = $signed(x_q[Width-1:Width-33]) + $signed({32'b0, x_q[4]});
  end
  assign sine_o = sine[32] == sine[31] ? sine[31:0] : {sine[32], {31{~sine[32]}}};
  assign cosine_o = cosine[32] == cosine[31] ? cosine[31:0] : {cosine[32], {31{~cosine[32]}}};

  // paper: its words are shorter than the shifter's.
  logic unused_bits;
  assign unused_bits = ^{x_shifted[38:Width], y_shifted[38:Width], x_shifted[0], y_shifted[0]};

endmodule
