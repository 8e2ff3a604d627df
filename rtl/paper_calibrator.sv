// SPDX-License-Identifier: Apache-2.0
// Calibrator of the paper arithmetic, Eq (12), on the parameter registers:
// du = u - b1, dv = v - b2; U1 = a2 du, V1 = a1 dv; U2 = U1 cos beta, V2 = V1 + U1 sin beta.
//
// Latency: one product in each of cycles 0..3; outputs valid from cycle 4 to cycle 31. In cycles 4 and 5
// a1 a2 cos beta, valid from cycle 6. RegisteredTable: sine and cosine come in cycle 1, still before their use.
// Inputs stable in cycles 0..5. State changes only if run_i.
//
// u_i .. b2_i   s32, Q1.31
// beta_i        u32, 2^-32 turn
// cal_s_o       s32, Q1.31: U2
// cal_c_o       s32, Q1.31: V2
// det_o         s32, Q1.31: a1 a2 cos beta
// mirror_o      cos beta < 0: how the paper's parameters show rotation against the reference
// saturated_o   one of the differences, products or the sum was clamped
//
// Rounding: products truncated to Q1.31 (floor); every result clamped to s32.
module paper_calibrator #(
  parameter int RegisteredTable = 0
) (
  input  logic               clk_i,
  input  logic               rst_ni,
  input  logic               run_i,
  input  logic         [4:0] cycle_i,
  input  logic signed [31:0] u_i,
  input  logic signed [31:0] v_i,
  input  logic signed [31:0] a1_i,
  input  logic signed [31:0] a2_i,
  input  logic signed [31:0] b1_i,
  input  logic signed [31:0] b2_i,
  input  logic        [31:0] beta_i,
  output logic signed [31:0] cal_s_o,
  output logic signed [31:0] cal_c_o,
  output logic signed [31:0] det_o,
  output logic               mirror_o,
  output logic               saturated_o
);

  // Of a s35: does it exceed s32?
  function automatic logic exceeds(input logic [3:0] upper);
    exceeds = (upper != {4{upper[3]}});
  endfunction

  function automatic logic signed [31:0] clamp(input logic signed [34:0] value);
    clamp = exceeds(value[34:31]) ? {value[34], {31{~value[34]}}} : value[31:0];
  endfunction

  // What each cycle's product is
  typedef enum logic [4:0] {
    ProductU1  = 5'd0,
    ProductV1  = 5'd1,
    ProductU2  = 5'd2,
    ProductV2  = 5'd3,
    ProductA1A2 = 5'd4,
    ProductDet = 5'd5
  } cycle_e;

  logic signed [31:0] u1_q, v1_q, u2_q, v2_q, det_q;
  logic mirror_q, saturated_q;

  logic signed [31:0] sine, cosine;
  paper_lookup #(
    .Registered(RegisteredTable)
  ) u_lookup (
    .clk_i,
    .enable_i(run_i),
    .angle_i(beta_i),
    .sine_o(sine),
    .cosine_o(cosine)
  );

  logic signed [34:0] offset_free;
  assign offset_free = cycle_i[0] ? 35'(v_i) - 35'(b2_i) : 35'(u_i) - 35'(b1_i);

  logic signed [31:0] factor_a, factor_b;
  always_comb begin
    unique case (cycle_i)
      ProductU1: {factor_a, factor_b} = {a2_i, clamp(offset_free)};
      ProductV1: {factor_a, factor_b} = {a1_i, clamp(offset_free)};
      ProductU2: {factor_a, factor_b} = {u1_q, cosine};
      ProductV2: {factor_a, factor_b} = {u1_q, sine};
      ProductA1A2: {factor_a, factor_b} = {a1_i, a2_i};
      default: {factor_a, factor_b} = {det_q, cosine};
    endcase
  end

  logic signed [67:0] product;
  paper_multiplier u_multiplier (
    .a_i(34'(factor_a)),
    .b_i(34'(factor_b)),
    .product_o(product)
  );

  logic signed [34:0] result;
  logic clamped;
  assign result = $signed(product[65:31]) + ((cycle_i == ProductV2) ? 35'(v1_q) : 35'sd0);
  assign clamped = exceeds(result[34:31]) || (!cycle_i[1] && exceeds(offset_free[34:31]));

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      u1_q <= '0;
      v1_q <= '0;
      u2_q <= '0;
      v2_q <= '0;
      det_q <= '0;
      mirror_q <= 1'b0;
      saturated_q <= 1'b0;
    end else if (run_i && (cycle_i <= ProductV2)) begin
      unique case (cycle_i)
        ProductU1: u1_q <= clamp(result);
        ProductV1: v1_q <= clamp(result);
        ProductU2: u2_q <= clamp(result);
        default: v2_q <= clamp(result);
      endcase
      mirror_q <= cosine[31];
      saturated_q <= clamped || (saturated_q && (cycle_i != ProductU1));
    end else if (run_i && (cycle_i == ProductA1A2 || cycle_i == ProductDet)) begin
      det_q <= clamp(result);
    end
  end

  assign cal_s_o = u2_q;
  assign cal_c_o = v2_q;
  assign det_o = det_q;
  assign mirror_o = mirror_q;
  assign saturated_o = saturated_q;

  logic unused_bits;
  assign unused_bits = ^{product[67:66], product[30:0]};

endmodule
