// SPDX-License-Identifier: Apache-2.0
// Amplitude sqrt(a^2 + b^2) of Eq (9) by the paper's iteration, Eq (10): y <- y^2 - x + y from 0,
// 30 times. As printed it converges to the negative root, hence the negation; serves roots 0.2..0.8.
//
// Latency: one tick. cycle 0: a^2; cycle 1: x and the first iteration (y = -x); cycles 2..30: the
// others. Outputs valid in cycle 31. Inputs stable in cycles 0 and 1. State changes only if run_i.
//
// a_i, b_i      s32, Q1.31
// amplitude_o   s32, Q1.31
// saturated_o   the sum of squares was 1 or more
//
// Rounding: sum of squares and y^2 truncated to Q1.31; every y clamped to s32.
module paper_square_root (
  input  logic               clk_i,
  input  logic               rst_ni,
  input  logic               run_i,
  input  logic         [4:0] cycle_i,
  input  logic signed [31:0] a_i,
  input  logic signed [31:0] b_i,
  output logic signed [31:0] amplitude_o,
  output logic               saturated_o
);

  logic [62:0] a_square_q;
  logic [30:0] x_q;
  logic signed [31:0] y_q, y_d;
  logic saturated_q;

  logic signed [31:0] operand;
  always_comb begin
    case (cycle_i)
      5'd0: operand = a_i;
      5'd1: operand = b_i;
      default: operand = y_q;
    endcase
  end

  logic signed [67:0] square;
  paper_multiplier u_multiplier (
    .a_i(34'(operand)),
    .b_i(34'(operand)),
    .product_o(square)
  );

  // The sum reaches 2^63.
  logic [63:0] sum;
  logic [30:0] x_d;
  logic saturated_d;
  assign sum = {1'b0, a_square_q} + {1'b0, square[62:0]};
  assign saturated_d = |sum[63:62];
  assign x_d = saturated_d ? '1 : sum[61:31];

  logic signed [33:0] next;
  logic overflow;
  assign next = 34'($signed(square[64:31])) - $signed({3'b000, x_q}) + 34'(y_q);
  assign overflow = (next[33] != next[31]) || (next[32] != next[31]);
  assign y_d = overflow ? {next[33], {31{~next[33]}}} : next[31:0];

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      a_square_q <= '0;
      x_q <= '0;
      y_q <= '0;
      saturated_q <= 1'b0;
    end else if (run_i) begin
      if (cycle_i == 5'd0) begin
        a_square_q <= square[62:0];
      end else if (cycle_i == 5'd1) begin
        x_q <= x_d;
        saturated_q <= saturated_d;
        y_q <= -$signed({1'b0, x_d});
      end else if (cycle_i != 5'd31) begin
        y_q <= y_d;
      end
    end
  end

  // -y of the most negative word is clamped (no flag).
  assign amplitude_o = (y_q == 32'h8000_0000) ? 32'h7fff_ffff : -y_q;
  assign saturated_o = saturated_q;

  logic unused_bits;
  assign unused_bits = ^{square[67:65], sum[30:0]};

endmodule
