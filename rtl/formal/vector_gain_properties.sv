// SPDX-License-Identifier: Apache-2.0
// vector_gain.sv by its definition: sat((x 8 G) >>r (32 + shift)), G = 2^28 + Gain. The two products
// are cut (scripts/tool formal): any numbers in the range that digits of 19 bits give.
module vector_gain_properties (
  input logic               clk_i,
  input logic signed [38:0] x_i,
  input logic        [6:0]  shift_i
);

  logic [31:0] magnitude;
  logic        saturated;
  vector_gain dut (
    .clk_i, .active_i (1'b1), .x_i, .shift_i, .magnitude_o (magnitude), .saturated_o (saturated)
  );
  (* hierconn *) logic signed [46:0] \dut.low ;
  (* hierconn *) logic signed [46:0] \dut.high ;

  // A vector that fills 35 bits in addition to the sign leaves the CORDIC below 2^36.3.
  localparam logic signed [38:0] MostX    = 39'sd137438953471;  // 2^37 - 1
  localparam logic signed [46:0] MostLow  = 47'sd524287 * 47'sd57580981;
  localparam logic signed [46:0] MostHigh = 47'sd262143 * 47'sd57580981;
  logic signed [79:0] x, low, high;
  logic [79:0] product, product_before;
  assign x = x_i;
  assign low = \dut.low ;
  assign high = \dut.high ;
  assign product = (x <<< 28) + (high <<< 19) + low;

  logic after = 1'b0;
  always @(posedge clk_i) begin
    after <= 1'b1;
    product_before <= product;
  end

  // (x 8 G) >>r (32 + s) = (x G + 2^(28 + s)) >> (29 + s); a shift of 64 or more leaves nothing.
  logic [95:0] due;
  assign due = ({16'd0, product_before} + (96'd1 << (7'd28 + shift_i[5:0]))) >> (7'd29 + shift_i[5:0]);

  always @* begin
    assume (x_i >= 0 & x_i <= MostX);
    assume (\dut.low >= 0 & \dut.low <= MostLow & \dut.high >= 0 & \dut.high <= MostHigh);
    if (after) begin
      if (shift_i[6]) assert (magnitude == 32'd0 & ~saturated);
      else begin
        assert (saturated == (due > 96'h7FFF_FFFF));
        assert (magnitude == (saturated ? 32'h7FFF_FFFF : due[31:0]));
      end
    end
  end

endmodule
