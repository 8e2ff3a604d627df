// SPDX-License-Identifier: Apache-2.0
// Sine and cosine from a table of 512 entries per turn with linear interpolation, for the paper's
// Eqs (11) and (12). Combinational, or with Registered = 1 a clock with enable_i later.
//
// angle_i    u32, 2^-32 turn: index in bits 31:23, fraction in bits 22:0
// sine_o     s32, Q1.31
// cosine_o   s32, Q1.31: sine of angle_i plus a quarter turn
//
// Rounding: table entries to nearest, the interpolated part truncated (floor).
// The table holds a quarter wave; the other three follow by symmetry, exactly.
module paper_lookup #(
  parameter int Registered = 0
) (
  input  logic               clk_i,
  input  logic               enable_i,
  input  logic        [31:0] angle_i,
  output logic signed [31:0] sine_o,
  output logic signed [31:0] cosine_o
);

  function automatic logic signed [31:0] interpolated(input logic [31:0] angle);
    logic falling, negative;
    logic [7:0] index;
    logic [6:0] interval;
    logic signed [31:0] entry;
    logic signed [25:0] rise;
    logic signed [23:0] fraction;
    logic signed [49:0] product;
    negative = angle[31];
    falling = angle[30];
    // Second and fourth quarter run through the table backwards.
    index = falling ? 8'd128 - {1'b0, angle[29:23]} : {1'b0, angle[29:23]};
    interval = angle[29:23] ^ {7{falling}};
    entry = {1'b0, paper_sine_table::sine(index)};
    rise = {1'b0, paper_sine_table::rise(interval)};
    if (negative) entry = -entry;
    if (negative != falling) rise = -rise;
    fraction = {1'b0, angle[22:0]};
    product = rise * fraction;
    interpolated = entry + 32'(product >>> 23);
  endfunction

  logic signed [31:0] sine, cosine;
  assign sine = interpolated(angle_i);
  assign cosine = interpolated(angle_i + 32'h4000_0000);

  // No reset: every use is a clock after the angle's.
  if (Registered != 0) begin : g_registered
    logic signed [31:0] sine_q, cosine_q;
    always_ff @(posedge clk_i) begin
      if (enable_i) begin
        sine_q <= sine;
        cosine_q <= cosine;
      end
    end
    assign sine_o = sine_q;
    assign cosine_o = cosine_q;
  end else begin : g_combinational
    logic unused_clock;
    assign unused_clock = clk_i ^ enable_i;
    assign sine_o = sine;
    assign cosine_o = cosine;
  end

endmodule
