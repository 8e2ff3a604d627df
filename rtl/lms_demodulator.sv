// SPDX-License-Identifier: Apache-2.0
// LMS demodulator (Eqs (13) to (20)), stage T3, both channels on one multiplier, and the products of
// LOAD (Eq (8)).
//
//   weight_i                s48, Q2.46: place 0 of the ring; weight_q31_i: the same >>r 15, s34
//   sine_i, cosine_i        s32, Q1.31
//   difference_i            s34, Q31: D = data - c >>r 15, u's in cycle 3, v's in cycle 7
//   steps_i                 u31, Q1.31, registers; copied at the tick's start (a1, a2 for LOAD)
//   slew_i                  JUDGE.SLEW, copied likewise
//   error_o                 s32, Q1.31, valid with error_valid_o: u in cycle 4, v in cycle 8
//   weight_o                s48, Q2.46, valid with weight_valid_o, when weight_i leaves place 0
//
//   err = sat(D - (a sine + b cosine) >>r 31), exactly sat of
//         floor((D 2^31 + 2^30 - 1 - a sine - b cosine) / 2^31), one rounding of the exact sum
//   err_s = err as slew_limit.sv leaves it; error_o is err
//   g = (err_s step) >>r 16, dW = (g r) >>r 31 or g, W' = sat(W + dW)
// Operands are chosen in one cycle and multiplied in the next. Cycles (of choice):
//   0 1 3, 4 5 7   a sine, b cosine, D
//   14 + 2 i       err step_i of weight i = 0..2; 15 + 2 i: g r_i; written at the end of 16, 18, 19
//   20 + 2 i       the same for v; written at the end of 22, 24, 25
// LOAD: the choices 14, 16 (20, 22) are amplitude times cosine, sine (-sine, cosine), kept in the
// odd cycles, and rounded as g is.
module lms_demodulator (
  input  logic               clk_i,
  input  logic               rst_ni,
  input  logic               boundary_i,
  input  logic               active_i,       // T3 holds a sample, or L1 or L2 runs
  input  logic        [ 4:0] cycle_i,
  input  logic               load_u_i,       // L1
  input  logic               load_v_i,       // L2
  input  logic               load_u_start_i,
  input  logic               load_v_start_i,
  input  logic        [30:0] a1_i,
  input  logic        [30:0] a2_i,
  input  steps_t             steps_i,
  input  logic        [ 2:0] slew_i,
  input  logic signed [47:0] weight_i,
  input  logic signed [33:0] weight_q31_i,
  input  logic signed [33:0] difference_i,
  input  logic signed [31:0] sine_i,
  input  logic signed [31:0] cosine_i,
  output logic               error_valid_o,
  output logic signed [31:0] error_o,
  output logic               error_saturated_o,
  output logic               weight_valid_o,
  output logic signed [47:0] weight_o,
  output logic               weight_saturated_o
);

  logic load;
  assign load = load_u_i || load_v_i;

  // Steps as they were at the tick's start. They begin at their registers' reset value: flip-flops of
  // this family begin at 0, so a bit that begins at 1 is kept inverted, and its copy had better be.
  localparam logic [31:0] StepReset = capsoc_coprocessor_pkg::STEP_AU_RESET;
  logic [30:0] step_au, step_bu, step_cu, step_av, step_bv, step_cv;
  logic [30:0] step_au_q, step_bu_q, step_cu_q, step_av_q, step_bv_q, step_cv_q;
  assign step_au = load_u_start_i ? a1_i : steps_i.au;
  assign step_bu = steps_i.bu;
  assign step_cu = steps_i.cu;
  assign step_av = load_v_start_i ? a2_i : steps_i.av;
  assign step_bv = steps_i.bv;
  assign step_cv = steps_i.cv;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      step_au_q <= StepReset[30:0];
      step_bu_q <= StepReset[30:0];
      step_cu_q <= StepReset[30:0];
      step_av_q <= StepReset[30:0];
      step_bv_q <= StepReset[30:0];
      step_cv_q <= StepReset[30:0];
    end else if (boundary_i) begin
      step_au_q <= step_au;
      step_bu_q <= step_bu;
      step_cu_q <= step_cu;
      step_av_q <= step_av;
      step_bv_q <= step_bv;
      step_cv_q <= step_cv;
    end
  end

  // What the update sees of an error.
  logic [2:0] slew_q;
  logic signed [31:0] limited;
  always_ff @(posedge clk_i) begin
    if (boundary_i) slew_q <= slew_i;
  end
  slew_limit u_slew_limit (
    .slew_i (slew_q),
    .error_i(error_o),
    .error_o(limited)
  );

  logic updating;  // cycles 14 to 25
  logic channel_v, second, third, odd;
  assign updating = cycle_i >= 5'd14;
  assign odd = cycle_i[0];
  assign channel_v = cycle_i >= 5'd20;
  assign second = cycle_i[4:1] == 4'd8 || cycle_i[4:1] == 4'd11;
  assign third = cycle_i[4:1] == 4'd9 || cycle_i[4:1] == 4'd12;

  logic [30:0] step_u, step_v;
  assign step_u = third ? step_cu_q : second && !load ? step_bu_q : step_au_q;
  assign step_v = third ? step_cv_q : second && !load ? step_bv_q : step_av_q;

  logic signed [47:0] a_q;
  logic signed [31:0] b_q, error_u_q, error_v_q;
  logic signed [79:0] product;
  multiplier_48x32 u_multiplier (
    .a_i      (a_q),
    .b_i      (b_q),
    .product_o(product)
  );

  logic signed [47:0] gained;  // g: s63 >>r 16
  assign gained = $signed(product[63:16]) + $signed({47'b0, product[15]});

  // Estimate: first sine, then cosine. Update: the error, then the reference.
  logic take_cosine, take_reference;
  assign take_reference = !updating || odd || load;
  assign take_cosine = !updating ? odd : load ? second == load_v_i : second;

  always_ff @(posedge clk_i) begin
    if (active_i && !(updating && load && odd)) begin
      if (!updating) a_q <= 48'(weight_q31_i);
      else if (odd) a_q <= gained;
      else a_q <= $signed({17'b0, channel_v ? step_v : step_u});
      if (take_reference) b_q <= take_cosine ? cosine_i : sine_i;
      else b_q <= channel_v ? error_v_q : error_u_q;
    end
  end

  logic signed [65:0] sum_q, term;
  logic add_data, add_product;
  assign add_data = cycle_i == 5'd3 || cycle_i == 5'd7;
  assign add_product = cycle_i == 5'd1 || cycle_i == 5'd2 || cycle_i == 5'd5 || cycle_i == 5'd6;
  assign term = add_data ? $signed({difference_i[33], difference_i, 31'h3FFF_FFFF}) : ~$signed(product[65:0]);
  logic signed [66:0] sum;
  assign sum = $signed({sum_q, 1'b1}) + $signed({term, !add_data});

  logic capture_u, capture_v;
  assign capture_u = active_i && cycle_i == 5'd4;
  assign capture_v = active_i && cycle_i == 5'd8;
  assign error_saturated_o =
      error_valid_o && !(&sum_q[65:62] || ~|sum_q[65:62]);
  assign error_o = &sum_q[65:62] || ~|sum_q[65:62] ? sum_q[62:31] : {sum_q[65], {31{~sum_q[65]}}};
  assign error_valid_o = (capture_u || capture_v) && !load;

  always_ff @(posedge clk_i) begin
    if (boundary_i || capture_u) sum_q <= '0;
    else if (active_i && (add_data || add_product)) sum_q <= sum[66:1];
    if (capture_u) error_u_q <= limited;
    if (capture_v) error_v_q <= limited;
  end

  // W' = W + (p >> n) and the rounding bit as a carry. -sine of LOAD: -p = ~p + 1, whose rounding
  // bit is set unless p's lower half is above one half.
  logic signed [47:0] delta;
  logic round, full, negate;
  assign full = (third && odd) || load;
  assign negate = load_v_i && second;
  always_comb begin
    if (!full) begin
      delta = product[78:31];
      round = product[30];
    end else if (negate) begin
      delta = ~product[63:16];
      round = !product[15] || ~|product[14:0];
    end else begin
      delta = product[63:16];
      round = product[15];
    end
  end

  logic signed [49:0] updated;
  logic over;
  assign updated = $signed({weight_i[47], weight_i, 1'b1}) + $signed({delta[47], delta, round});
  assign over = updated[49] != updated[48];
  assign weight_o = over ? {updated[49], {47{~updated[49]}}} : updated[48:1];
  assign weight_saturated_o = weight_valid_o && over;
  // The constants of a LOAD are in the ring already.
  assign weight_valid_o = active_i && updating && !(load && third && odd) &&
      (!load || load_v_i == channel_v);

  logic [2:0] unused_bits;
  assign unused_bits = {product[79], sum[0], updated[0]};

endmodule
