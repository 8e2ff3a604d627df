// SPDX-License-Identifier: Apache-2.0
// Checks a micro-rotation of vectoring_step.sv against its definition, in words wide enough for all values.
// The results are x + d (y >>r i), y - d (x >>r i) and z + d A[i], with i = 3 n + Offset and d = +1 if y >= 0, else -1.
module vectoring_step_properties #(
  parameter int Offset = 0
) (
  input logic               clk_i,
  input logic        [3:0]  number_i,
  input logic signed [38:0] x_i, y_i,
  input logic        [36:0] z_i
);

  logic signed [38:0] x, y;
  logic        [36:0] z;
  vectoring_step #(.Offset (Offset)) dut (
    .thirds_i (2'(number_i / 4'd3)), .rest_i (2'(number_i % 4'd3)), .x_i, .y_i, .z_i, .x_o (x), .y_o (y), .z_o (z)
  );

  logic [5:0] i;
  logic signed [79:0] wide_x, wide_y, half, x_shifted, y_shifted, x_due, y_due;
  logic [36:0] angle, z_due;
  assign i = 6'd3 * number_i + Offset;
  assign wide_x = x_i;
  assign wide_y = y_i;
  assign half = i == 6'd0 ? 80'sd0 : 80'sd1 <<< (i - 6'd1);
  assign x_shifted = (wide_x + half) >>> i;
  assign y_shifted = (wide_y + half) >>> i;
  assign x_due = y_i >= 0 ? wide_x + y_shifted : wide_x - y_shifted;
  assign y_due = y_i >= 0 ? wide_y - x_shifted : wide_y + x_shifted;
  assign angle = cordic_pkg::ANGLE_37 >> (37 * i);
  assign z_due = y_i >= 0 ? z_i + angle : z_i - angle;

  always @* begin
    assume (number_i < 4'd10);
    assert (x == x_due[38:0] & y == y_due[38:0] & z == z_due);
  end

endmodule
