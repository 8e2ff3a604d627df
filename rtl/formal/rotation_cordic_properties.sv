// SPDX-License-Identifier: Apache-2.0
// Checks a micro-rotation of rotation_cordic.sv against its definition, in words wide enough for all values.
// The results are x - d (y >>r i), y + d (x >>r i) and z - d A[i], with d = +1 if z >= 0, else -1 (paper: shifts are
// truncated).
// The output is rounded and clamped.
module rotation_cordic_properties #(
  parameter int Paper = 0
) (
  input logic        clk_i,
  input logic        start_i,
  input logic        run_i,
  input logic [4:0]  step_i,
  input logic [47:0] phase_i
);

  localparam int Stages = Paper != 0 ? 28 : 30;
  localparam int Width  = Paper != 0 ? 33 : 38;
  localparam int ZWidth = Paper != 0 ? 32 : 37;

  logic signed [31:0] sine, cosine;
  rotation_cordic #(.Paper (Paper)) dut (
    .clk_i, .start_i, .run_i, .step_i, .phase_i, .sine_o (sine), .cosine_o (cosine)
  );
  (* hierconn *) logic [Width-1:0]  \dut.x_q ;
  (* hierconn *) logic [Width-1:0]  \dut.y_q ;
  (* hierconn *) logic [ZWidth-1:0] \dut.z_q ;
  logic signed [Width-1:0]  x, y;
  logic signed [ZWidth-1:0] z;
  assign x = \dut.x_q ;
  assign y = \dut.y_q ;
  assign z = \dut.z_q ;

  // The start: p >>r 11 (paper: upper 32 bits); outside [-quarter, quarter) half a turn on, from -x0.
  logic [47:0] p;
  logic signed [ZWidth-1:0] z_start;
  logic signed [Width-1:0]  x_start;
  assign p = Paper != 0 ? phase_i >> 16 : {11'b0, phase_i[47:11]} + {47'b0, phase_i[10]};
  assign z_start = p[ZWidth-1] != p[ZWidth-2] ? p[ZWidth-1:0] ^ {1'b1, {(ZWidth-1){1'b0}}} : p[ZWidth-1:0];
  assign x_start = Paper != 0 ? 33'sd1304065748 : 38'sd41730103921;

  logic signed [79:0] wide_x, wide_y, half, x_shifted, y_shifted;
  logic [ZWidth-1:0] angle;
  assign wide_x = x;
  assign wide_y = y;
  assign half = Paper != 0 || step_i == 5'd0 ? 80'sd0 : 80'sd1 <<< (step_i - 5'd1);
  assign x_shifted = (wide_x + half) >>> step_i;
  assign y_shifted = (wide_y + half) >>> step_i;
  if (Paper != 0) begin : gen_angle_paper
    assign angle = cordic_pkg::ANGLE_32 >> (32 * step_i);
  end else begin : gen_angle_precise
    assign angle = cordic_pkg::ANGLE_37 >> (37 * step_i);
  end

  logic after = 1'b0;
  logic signed [Width-1:0] x_due, y_due;
  logic [ZWidth-1:0] z_due;
  always @(posedge clk_i) begin
    after <= 1'b1;
    {x_due, y_due, z_due} <= {x, y, z};
    if (start_i) begin
      x_due <= p[ZWidth-1] != p[ZWidth-2] ? -x_start : x_start;
      y_due <= '0;
      z_due <= z_start;
    end else if (run_i & step_i < Stages) begin
      x_due <= z >= 0 ? wide_x - y_shifted : wide_x + y_shifted;
      y_due <= z >= 0 ? wide_y + x_shifted : wide_y - x_shifted;
      z_due <= z >= 0 ? z - angle : z + angle;
    end
  end

  // The output; the rotation keeps its words below 2^36, so a rounded one has 33 bits.
  logic signed [79:0] sine_due, cosine_due;
  localparam logic signed [79:0] Most    = 80'sd1 <<< (Width - 2);
  localparam logic signed [79:0] Highest = 80'sd2147483647;
  localparam logic signed [79:0] Lowest  = -80'sd2147483648;
  assign sine_due = Paper != 0 ? wide_y : (wide_y + 80'sd16) >>> 5;
  assign cosine_due = Paper != 0 ? wide_x : (wide_x + 80'sd16) >>> 5;

  always @* begin
    if (after) assert (x == x_due & y == y_due & z == z_due);
    if (wide_y < Most & wide_y >= -Most) begin
      assert (sine == (sine_due > Highest ? Highest : sine_due < Lowest ? Lowest : sine_due));
    end
    if (wide_x < Most & wide_x >= -Most) begin
      assert (cosine == (cosine_due > Highest ? Highest : cosine_due < Lowest ? Lowest : cosine_due));
    end
  end

endmodule
