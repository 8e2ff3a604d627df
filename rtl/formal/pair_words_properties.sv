// SPDX-License-Identifier: Apache-2.0
// The words of a 48-bit register by their definition (pair_words.sv), for every value.
module pair_words_properties #(
  parameter int Paper = 0
) (
  input logic        clk_i,
  input logic        coefficient_i,
  input logic [47:0] value_i,
  input logic [31:0] high_i, low_i
);

  logic [31:0] high, low;
  logic [47:0] coefficient, phase;
  pair_words #(.Paper (Paper)) dut (
    .coefficient_i, .value_i, .high_o (high), .low_o (low),
    .high_i, .low_i, .coefficient_o (coefficient), .phase_o (phase)
  );

  // s64 throughout, so that nothing overflows.
  localparam logic signed [63:0] Largest  = 64'sd2147483647;
  localparam logic signed [63:0] Smallest = -64'sd2147483648;
  logic signed [63:0] value, rounded, upper, rest, lower, written, written_rounded, clamped;
  assign value   = $signed({{16{value_i[47]}}, value_i});
  assign rounded = (value + 64'sd16384) >>> 15;
  assign upper   = rounded > Largest ? Largest : rounded < Smallest ? Smallest : rounded;
  assign rest    = value - (upper <<< 15);
  assign lower   = rest > Largest ? Largest : rest < Smallest ? Smallest : rest;
  assign written = ($signed({{32{high_i[31]}}, high_i}) <<< 15) + $signed({{32{low_i[31]}}, low_i});
  assign written_rounded = (written + 64'sd16384) >>> 15;
  assign clamped = written_rounded > Largest ? Largest :
                   written_rounded < Smallest ? Smallest : written_rounded;

  always @* begin
    if (coefficient_i) assert (high == upper[31:0] & low == lower[31:0]);
    else assert ({high, low} == {value_i[47:16], 16'd0, value_i[15:0]});
    if (Paper != 0) assert (coefficient == {clamped[32:0], 15'd0});
    else assert (coefficient == written[47:0]);
    assert (phase == {high_i, low_i[15:0]});
  end

endmodule
