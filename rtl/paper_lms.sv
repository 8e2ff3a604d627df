// SPDX-License-Identifier: Apache-2.0
// LMS demodulator of the paper arithmetic, Eqs (13) to (20): both channels, one multiplier, every
// product truncated to Q1.31 by itself.
//
// estimate = a sine + b cosine + c; error = data - estimate; g = error * step; a += g sine, b += g
// cosine, c += g, with the gained error g of the weight's own step.
//
// Latency: channel U in cycles 0..6, V in cycles 7..13; outputs valid from cycle 14 to cycle 31.
// Inputs stable in cycles 0..13. State changes only if run_i.
//
// u_i, v_i, sine_i, cosine_i   s32, Q1.31
// steps_i                      u31, Q1.31; StepShift: right shift of every step
// slew_i                       JUDGE.SLEW: what of the error an update may see
// weights_i, weights_o         s48, Q2.46, of which this arithmetic has bits 46:15 (Q1.31)
// error_u_o, error_v_o         s32, Q1.31, before the update
// error_saturated_o            an error was clamped
// weights_saturated_o          a new weight was clamped
//
// Rounding: floor; errors and new weights clamped to s32.
module paper_lms #(
  parameter int StepShift = 0
) (
  input  logic               clk_i,
  input  logic               rst_ni,
  input  logic               run_i,
  input  logic         [4:0] cycle_i,
  input  logic signed [31:0] u_i,
  input  logic signed [31:0] v_i,
  input  logic signed [31:0] sine_i,
  input  logic signed [31:0] cosine_i,
  input  steps_t             steps_i,
  input  logic         [2:0] slew_i,
  input  weights_t           weights_i,
  output logic signed [31:0] error_u_o,
  output logic signed [31:0] error_v_o,
  output weights_t           weights_o,
  output logic               error_saturated_o,
  output logic               weights_saturated_o
);

  // What the multiplier does in a slot of a channel.
  typedef enum logic [2:0] {
    SlotSine   = 3'd0,  // a sine
    SlotCosine = 3'd1,  // b cosine, then the error
    SlotGainA  = 3'd2,
    SlotA      = 3'd3,
    SlotGainB  = 3'd4,
    SlotB      = 3'd5,
    SlotC      = 3'd6
  } slot_e;
  localparam logic [4:0] SlotsOfU = 5'd7;  // then as many of V

  logic active, channel_v;
  logic [2:0] slot;
  assign active = run_i && (cycle_i < SlotsOfU + SlotsOfU);
  assign channel_v = (cycle_i >= SlotsOfU);
  assign slot = channel_v ? 3'(cycle_i - SlotsOfU) : cycle_i[2:0];

  // Of a s36: does it exceed s32?
  function automatic logic exceeds(input logic [4:0] upper);
    exceeds = (upper != {5{upper[4]}});
  endfunction

  function automatic logic signed [31:0] clamp(input logic signed [35:0] value);
    clamp = exceeds(value[35:31]) ? {value[35], {31{~value[35]}}} : value[31:0];
  endfunction

  logic signed [31:0] weight_a, weight_b, weight_c, data, error;
  logic [30:0] step_a, step_b, step_c;
  logic signed [31:0] error_u_q, error_v_q;
  assign weight_a = channel_v ? weights_i.av[46:15] : weights_i.au[46:15];
  assign weight_b = channel_v ? weights_i.bv[46:15] : weights_i.bu[46:15];
  assign weight_c = channel_v ? weights_i.cv[46:15] : weights_i.cu[46:15];
  assign step_a = channel_v ? steps_i.av : steps_i.au;
  assign step_b = channel_v ? steps_i.bv : steps_i.bu;
  assign step_c = channel_v ? steps_i.cv : steps_i.cu;
  assign data = channel_v ? v_i : u_i;
  slew_limit u_slew_limit (
    .slew_i,
    .error_i(channel_v ? error_v_q : error_u_q),
    .error_o(error)
  );

  // First product of the estimate (s33), then the gained error (s32).
  logic signed [32:0] part_q;

  logic signed [31:0] gained;
  assign gained = part_q[31:0];

  logic signed [31:0] factor_a, factor_b;
  always_comb begin
    unique case (slot)
      SlotSine: factor_a = weight_a;
      SlotCosine: factor_a = weight_b;
      SlotA, SlotB: factor_a = gained;
      default: factor_a = error;
    endcase
    unique case (slot)
      SlotSine, SlotA: factor_b = sine_i;
      SlotCosine, SlotB: factor_b = cosine_i;
      SlotGainA: factor_b = {1'b0, step_a >> StepShift};
      SlotGainB: factor_b = {1'b0, step_b >> StepShift};
      default: factor_b = {1'b0, step_c >> StepShift};
    endcase
  end

  logic signed [67:0] product;
  logic signed [32:0] truncated;
  paper_multiplier u_multiplier (
    .a_i(34'(factor_a)),
    .b_i(34'(factor_b)),
    .product_o(product)
  );
  assign truncated = product[63:31];

  logic signed [35:0] estimate, difference, moved;
  logic signed [31:0] old;
  assign estimate = 36'(part_q) + 36'(truncated) + 36'(weight_c);
  assign difference = 36'(data) - estimate;
  always_comb begin
    unique case (slot)
      SlotA: old = weight_a;
      SlotB: old = weight_b;
      default: old = weight_c;
    endcase
  end
  assign moved = 36'(old) + 36'(truncated);

  logic signed [31:0] au_q, bu_q, cu_q, av_q, bv_q, cv_q;
  logic error_saturated_q, weights_saturated_q;

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      part_q <= '0;
      error_u_q <= '0;
      error_v_q <= '0;
      au_q <= '0;
      bu_q <= '0;
      cu_q <= '0;
      av_q <= '0;
      bv_q <= '0;
      cv_q <= '0;
      error_saturated_q <= 1'b0;
      weights_saturated_q <= 1'b0;
    end else if (active) begin
      if (cycle_i == 5'd0) begin
        error_saturated_q <= 1'b0;
        weights_saturated_q <= 1'b0;
      end
      unique case (slot)
        SlotCosine: begin
          if (channel_v) error_v_q <= clamp(difference);
          else error_u_q <= clamp(difference);
          if (exceeds(difference[35:31])) error_saturated_q <= 1'b1;
        end
        SlotA, SlotB, SlotC: begin
          if (slot == SlotA && !channel_v) au_q <= clamp(moved);
          if (slot == SlotB && !channel_v) bu_q <= clamp(moved);
          if (slot == SlotC && !channel_v) cu_q <= clamp(moved);
          if (slot == SlotA && channel_v) av_q <= clamp(moved);
          if (slot == SlotB && channel_v) bv_q <= clamp(moved);
          if (slot == SlotC && channel_v) cv_q <= clamp(moved);
          if (exceeds(moved[35:31])) weights_saturated_q <= 1'b1;
        end
        default: part_q <= truncated;
      endcase
    end
  end

  assign error_u_o = error_u_q;
  assign error_v_o = error_v_q;
  assign weights_o.au = {au_q[31], au_q, 15'b0};
  assign weights_o.bu = {bu_q[31], bu_q, 15'b0};
  assign weights_o.cu = {cu_q[31], cu_q, 15'b0};
  assign weights_o.av = {av_q[31], av_q, 15'b0};
  assign weights_o.bv = {bv_q[31], bv_q, 15'b0};
  assign weights_o.cv = {cv_q[31], cv_q, 15'b0};
  assign error_saturated_o = error_saturated_q;
  assign weights_saturated_o = weights_saturated_q;

  logic unused_bits;
  assign unused_bits = ^{product[67:64], product[30:0], weights_i.au[47], weights_i.au[14:0], weights_i.bu[47], weights_i.bu[14:0],
                         weights_i.cu[47], weights_i.cu[14:0], weights_i.av[47], weights_i.av[14:0], weights_i.bv[47], weights_i.bv[14:0], weights_i.cv[47],
                         weights_i.cv[14:0]};

endmodule
