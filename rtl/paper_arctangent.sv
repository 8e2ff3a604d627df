// Arctangent by the paper's PI loop, Eq (11), P = 0, I = 1.9 rad per unit error, from 0, 30 times:
// error = y cos(angle) - x sin(angle), angle += I error. Needs amplitudes of about 0.3 .. 0.9; an
// input at exactly half a turn stays at 0.
//
// Latency: one tick. cycle 0 clears the angle, cycles 1..30 iterate, the output is valid in cycle
// 31. Inputs stable in cycles 1..30. State changes only if run_i.
//
// y_i, x_i      s32, Q1.31
// angle_o       u32, 2^-32 turn, wraps
// OperandBits   width of the operands of the error's products, 2..32: lower bits are cut off
//
// Rounding: every product truncated (floor).
module paper_arctangent #(
  parameter int OperandBits = 32
) (
  input  logic               clk_i,
  input  logic               rst_ni,
  input  logic               run_i,
  input  logic         [4:0] cycle_i,
  input  logic signed [31:0] y_i,
  input  logic signed [31:0] x_i,
  output logic        [31:0] angle_o
);

  localparam int Cut = 32 - OperandBits;
  localparam logic signed [33:0] IntegralGain = 34'sd1298774024;  // round(1.9 / 2pi * 2^32), Q31

  logic [31:0] angle_q, angle_d;

  logic signed [31:0] sine, cosine;
  paper_lookup u_lookup (
    .angle_i(angle_q),
    .sine_o(sine),
    .cosine_o(cosine)
  );

  logic signed [OperandBits-1:0] y_cut, x_cut, sine_cut, cosine_cut;
  assign y_cut = y_i[31:Cut];
  assign x_cut = x_i[31:Cut];
  assign sine_cut = sine[31:Cut];
  assign cosine_cut = cosine[31:Cut];

  logic signed [67:0] y_cosine, x_sine;
  if (OperandBits <= 18) begin : gen_narrow
    logic signed [2*OperandBits-1:0] y_product, x_product;
    assign y_product = y_cut * cosine_cut;
    assign x_product = x_cut * sine_cut;
    assign y_cosine = 68'(y_product);
    assign x_sine = 68'(x_product);
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
      if (cycle_i == 5'd0) begin
        angle_q <= '0;
      end else if (cycle_i != 5'd31) begin
        angle_q <= angle_d;
      end
    end
  end

  assign angle_o = angle_q;

  logic unused_bits;
  assign unused_bits = ^{y_i, x_i, sine, cosine, difference[67:65], difference[30:0], step[67:63], step[30:0]};

endmodule
