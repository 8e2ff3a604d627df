// SPDX-License-Identifier: Apache-2.0
// A step of k places is allowed if and only if shifting both words left by k and back loses nothing.
module normalise_step_properties (
  input logic               clk_i,
  input logic signed [16:0] x_i, y_i
);

  logic by16, by8, by4, by1;
  normalise_step dut (.x_i, .y_i, .by16_o (by16), .by8_o (by8), .by4_o (by4), .by1_o (by1));

  logic signed [16:0] x16, y16, x8, y8, x4, y4, x1, y1;
  assign x16 = x_i <<< 16;
  assign y16 = y_i <<< 16;
  assign x8  = x_i <<< 8;
  assign y8  = y_i <<< 8;
  assign x4  = x_i <<< 4;
  assign y4  = y_i <<< 4;
  assign x1  = x_i <<< 1;
  assign y1  = y_i <<< 1;

  always @* begin
    assert (by16 == (x16 >>> 16 == x_i & y16 >>> 16 == y_i));
    assert (by8 == (x8 >>> 8 == x_i & y8 >>> 8 == y_i));
    assert (by4 == (x4 >>> 4 == x_i & y4 >>> 4 == y_i));
    assert (by1 == (x1 >>> 1 == x_i & y1 >>> 1 == y_i));
  end

endmodule
