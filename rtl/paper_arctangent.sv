// SPDX-License-Identifier: Apache-2.0
// Arctangent by the paper's PI loop, Eq (11), P = 0, I = 1.9 rad per unit error, from 0, 30 times:
// error = y cos(angle) - x sin(angle), angle += I error. The loop needs amplitudes of about 0.3 to 0.9, and stays at 0
// for an input at half a turn. So, unless Plain, the vector is shifted until the larger word is in [0.25, 0.5), and
// negated if x < 0.
//
// Latency: one tick, of 32 clocks or with IterationClocks = 2 of 64. Clock 0 clears the angle. Clocks 1..30 iterate, and the outputs
// are valid in clock 31. With IterationClocks = 2 the vector is prepared in clock 0; sine and cosine come in clocks 1, 3 .. 59, the angle
// in 2, 4 .. 60; sine and cosine of the last angle in 61, and the outputs are valid in 62 and 63.
// Inputs stable in the whole tick. State changes only if run_i.
//
// y_i, x_i      s32, Q1.31
// angle_o       u32, 2^-32 turn, wraps
// magnitude_o   s32, Q1.31, 0 .. 2^31 - 1: y sin(angle) + x cos(angle), shifted back
// settled_o     |error| < 2^-10 (y sin + x cos) at the last angle, or the vector is zero
// OperandBits   width of the operands of the error's products, 2..32: lower bits are cut off
//
// Rounding: every product truncated (floor).
module paper_arctangent #(
  parameter int OperandBits = 32,
  parameter int Plain = 0,
  parameter int IterationClocks = 1
) (
  input  logic               clk_i,
  input  logic               rst_ni,
  input  logic               run_i,
  input  logic         [5:0] clock_i,
  input  logic signed [31:0] y_i,
  input  logic signed [31:0] x_i,
  output logic        [31:0] angle_o,
  output logic        [31:0] magnitude_o,
  output logic               settled_o
);

  localparam int Cut = 32 - OperandBits;
  localparam logic signed [33:0] IntegralGain = 34'sd1298774024;  // round(1.9 / 2pi * 2^32), Q31

  // The larger bit length of the one's complements, without sign; 30 is left as it is.
  logic [30:0] occupied;
  logic signed [31:0] y_shifted, x_shifted, y_folded, x_folded, y, x;
  logic [4:0] places;
  logic halve, fold;
  assign occupied = (y_i[30:0] ^ {31{y_i[31]}}) | (x_i[30:0] ^ {31{x_i[31]}});
  if (Plain != 0) begin : gen_plain
    assign halve = 1'b0;
    assign places = '0;
    assign fold = 1'b0;
  end else begin : gen_prepared
    assign halve = occupied[30];
    always_comb begin
      places = 5'd30;
      for (int i = 0; i < 30; i++) begin
        if (occupied[i]) places = 5'(29 - i);
      end
    end
    assign fold = x_shifted[31];
  end
  assign y_shifted = halve ? y_i >>> 1 : y_i <<< places;
  assign x_shifted = halve ? x_i >>> 1 : x_i <<< places;
  assign y_folded = fold ? -y_shifted : y_shifted;
  assign x_folded = fold ? -x_shifted : x_shifted;

  // What the loop works with, and when it steps.
  logic step_now;
  if (IterationClocks == 2) begin : gen_two_clocks
    logic signed [31:0] y_q, x_q;
    always_ff @(posedge clk_i) begin
      if (run_i && clock_i == 6'd0) {y_q, x_q} <= {y_folded, x_folded};
    end
    assign y = y_q;
    assign x = x_q;
    assign step_now = !clock_i[0] && clock_i != 6'd62;
  end else begin : gen_one_clock
    assign y = y_folded;
    assign x = x_folded;
    assign step_now = clock_i != 6'd31;
  end

  logic [31:0] angle_q, angle_d;

  logic signed [31:0] sine, cosine;
  paper_lookup #(
    .Registered(IterationClocks - 1)
  ) u_lookup (
    .clk_i,
    .enable_i(run_i),
    .angle_i(angle_q),
    .sine_o(sine),
    .cosine_o(cosine)
  );

  logic signed [OperandBits-1:0] y_cut, x_cut, sine_cut, cosine_cut;
  assign y_cut = y[31:Cut];
  assign x_cut = x[31:Cut];
  assign sine_cut = sine[31:Cut];
  assign cosine_cut = cosine[31:Cut];

  logic signed [67:0] y_cosine, x_sine, y_sine, x_cosine;
  if (OperandBits <= 18) begin : gen_narrow
    logic signed [2*OperandBits-1:0] y_product, x_product, y_along, x_along;
    assign y_product = y_cut * cosine_cut;
    assign x_product = x_cut * sine_cut;
    assign y_cosine = 68'(y_product);
    assign x_sine = 68'(x_product);
    assign y_along = y_cut * sine_cut;
    assign x_along = x_cut * cosine_cut;
    assign y_sine = 68'(y_along);
    assign x_cosine = 68'(x_along);
  end else begin : gen_wide
    paper_multiplier u_y_cosine (
      .a_i(34'(y_cut)),
      .b_i(34'(cosine_cut)),
      .product_o(y_cosine)
    );
    paper_multiplier u_x_sine (
      .a_i(34'(x_cut)),
      .b_i(34'(sine_cut)),
      .product_o(x_sine)
    );
    paper_multiplier u_y_sine (
      .a_i(34'(y_cut)),
      .b_i(34'(sine_cut)),
      .product_o(y_sine)
    );
    paper_multiplier u_x_cosine (
      .a_i(34'(x_cut)),
      .b_i(34'(cosine_cut)),
      .product_o(x_cosine)
    );
  end

  logic signed [67:0] difference;
  logic signed [33:0] error;
  assign difference = (y_cosine - x_sine) <<< (2 * Cut);
  assign error = difference[64:31];

  logic signed [67:0] step;
  paper_multiplier u_integral (
    .a_i(error),
    .b_i(IntegralGain),
    .product_o(step)
  );
  assign angle_d = angle_q + step[62:31];

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      angle_q <= '0;
    end else if (run_i) begin
      if (clock_i == 6'd0) begin
        angle_q <= '0;
      end else if (step_now) begin
        angle_q <= angle_d;
      end
    end
  end

  assign angle_o = {angle_q[31] ^ fold, angle_q[30:0]};

  // Of the angle that the loop ends with.
  logic signed [67:0] along_sum;
  logic signed [34:0] along, limit, distance, unshifted;
  assign along_sum = (y_sine + x_cosine) <<< (2 * Cut);
  assign along = $signed({along_sum[64], along_sum[64:31]});
  assign limit = along >>> 10;
  assign distance = error[33] ? -$signed({error[33], error}) : $signed({error[33], error});
  assign settled_o = distance < limit || (y_i == '0 && x_i == '0);
  assign unshifted = halve ? along <<< 1 : along >>> places;
  assign magnitude_o = unshifted[34] ? '0 : unshifted[33:31] != '0 ? 32'h7fff_ffff : unshifted[31:0];

  logic unused_bits;
  assign unused_bits = ^{y, x, sine, cosine, difference[67:65], difference[30:0],
                         along_sum[67:65], along_sum[30:0], step[67:63], step[30:0]};

endmodule
