// SPDX-License-Identifier: Apache-2.0
// The two vectors of T4, brought to the CORDIC's input format one after the other.
//
//   *_i          s48, Q2.46: places 3, 4, 5 of the weight ring
//   x_o, y_o     bits 48..12 of the s49 words, shifted left until the larger one fills its word
//   shift_o      the number of places + 2: F = 46 stands where T1's word has F = 62
// At the end of cycle 0 it takes (-a_v, b_v), ready in cycle 9; at the end of cycle 10 (b_u, a_u),
// which have then come to places 5 and 4, ready in cycle 19.
module polar_normaliser (
  input  logic        clk_i,
  input  logic        active_i,
  input  logic [ 4:0] cycle_i,
  input  logic [47:0] weight3_i,
  input  logic [47:0] weight4_i,
  input  logic [47:0] weight5_i,
  output logic [36:0] x_o,
  output logic [36:0] y_o,
  output logic [ 6:0] shift_o,
  output logic        zero_o
);

  logic [48:0] x_q, y_q;
  logic [6:0] shift_q;

  logic by16, by4, by1, unused_by8;
  normalise_step u_normalise_step (
    .x_i   (x_q[48:32]),
    .y_i   (y_q[48:32]),
    .by16_o(by16),
    .by8_o (unused_by8),
    .by4_o (by4),
    .by1_o (by1)
  );

  // -a_v takes 49 bits: its smallest value is -2.
  logic first;
  logic [48:0] y_load;
  assign first = cycle_i == 5'd0;
  assign y_load = (first ? ~{weight3_i[47], weight3_i} : {weight5_i[47], weight5_i}) + 49'(first);

  // Four choices of two select bits and a common enable: one LUT a bit.
  logic load;
  logic [1:0] choice;
  logic [48:0] x_next, y_next;
  assign load = first || cycle_i == 5'd10;
  assign choice = load ? 2'd0 : by16 ? 2'd1 : by4 ? 2'd2 : 2'd3;
  always_comb begin
    case (choice)
      2'd0: {x_next, y_next} = {weight4_i[47], weight4_i, y_load};
      2'd1: {x_next, y_next} = {x_q[32:0], 16'b0, y_q[32:0], 16'b0};
      2'd2: {x_next, y_next} = {x_q[44:0], 4'b0, y_q[44:0], 4'b0};
      default: {x_next, y_next} = {x_q[47:0], 1'b0, y_q[47:0], 1'b0};
    endcase
  end

  always_ff @(posedge clk_i) begin
    if (active_i && (load || by1)) begin
      x_q <= x_next;
      y_q <= y_next;
      shift_q <= load ? 7'd2 : shift_q + {2'b0, choice == 2'd1, 1'b0, choice == 2'd2, 1'b0,
                                          choice == 2'd3};
    end
  end

  assign x_o = x_q[48:12];
  assign y_o = y_q[48:12];
  assign shift_o = shift_q;
  assign zero_o = by1;

endmodule
