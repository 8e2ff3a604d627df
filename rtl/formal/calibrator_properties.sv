// SPDX-License-Identifier: Apache-2.0
// calibrator.sv by its definition. The products are cut (scripts/tool formal): any number in the range
// that weights up to 2 and differences up to 3 give.
//   Begin = 0: operands, det, the mirror and both calibrated words, from a boundary on
//   Begin = 15: the normalisation, from any S and C
module calibrator_properties #(
  parameter int Begin = 0
) (
  input logic               clk_i,
  input logic signed [33:0] weight_q31_i, weight4_i, difference_i
);

  logic calibrated_valid, calibrated_s, saturated, mirror, zero;
  logic [31:0] calibrated;
  logic [36:0] s, c;
  logic [6:0]  shift;
  logic        started = 1'b0;  // the first interval ends in the boundary, or is cycle 15
  logic [5:0]  cycle   = Begin;
  always @(posedge clk_i) begin
    started <= 1'b1;
    cycle   <= Begin == 0 & ~started ? 6'd0 : cycle + 6'd1;
  end

  calibrator dut (
    .clk_i, .boundary_i (Begin == 0 & ~started), .active_i (1'b1), .cycle_i (cycle[4:0]),
    .weight_q31_i, .weight4_i, .difference_i,
    .calibrated_valid_o (calibrated_valid), .calibrated_s_o (calibrated_s),
    .calibrated_o (calibrated), .saturated_o (saturated), .mirror_o (mirror),
    .s_o (s), .c_o (c), .shift_o (shift), .zero_o (zero)
  );
  (* hierconn *) logic signed [33:0] \dut.a_q ;
  (* hierconn *) logic signed [33:0] \dut.b_q ;
  (* hierconn *) logic signed [67:0] \dut.product ;
  (* hierconn *) logic signed [66:0] \dut.x_q ;
  (* hierconn *) logic signed [66:0] \dut.y_q ;

  localparam logic signed [67:0] Most    = 68'sd3 <<< 63;
  localparam logic signed [67:0] Highest = 68'sd2147483647;
  localparam logic signed [67:0] Lowest  = -68'sd2147483648;

  // Factors as they were in the cycle before their product; products by their cycle.
  logic signed [33:0] weight_before, du, dv;
  logic signed [34:0] weight4_before;
  logic signed [67:0] au_bv, det, au_dv, bu_dv, av_du, bv_du;
  always @(posedge clk_i) begin
    weight_before <= weight_q31_i;
    weight4_before <= ($signed({weight4_i[33], weight4_i}) + 35'sd1) >>> 1;
    if (cycle == 6'd2) du <= difference_i;
    if (cycle == 6'd6) dv <= difference_i;
    if (cycle == 6'd1) au_bv <= \dut.product ;
    if (cycle == 6'd5) det <= au_bv - \dut.product ;
    if (cycle == 6'd9) au_dv <= \dut.product ;
    if (cycle == 6'd10) bu_dv <= \dut.product ;
    if (cycle == 6'd12) av_du <= \dut.product ;
    if (cycle == 6'd13) bv_du <= \dut.product ;
  end

  logic signed [67:0] exact_s, exact_c, word;
  assign exact_c = det < 0 ? av_du - au_dv : au_dv - av_du;
  assign exact_s = det < 0 ? bu_dv - bv_du : bv_du - bu_dv;
  assign word = ((cycle == 6'd13 ? exact_c : exact_s) + 68'sd1073741824) >>> 31;

  // Normalisation, from one cycle to the next.
  logic signed [66:0] x_before, y_before;
  logic [6:0] shift_before, places;
  assign places = shift - shift_before;
  always @(posedge clk_i) begin
    x_before <= \dut.x_q ;
    y_before <= \dut.y_q ;
    shift_before <= shift;
  end

  always @* begin
    assume (\dut.product <= Most & \dut.product >= -Most);
    if (Begin == 0 & started) begin
      if (cycle == 6'd1 | cycle == 6'd5 | cycle == 6'd9 | cycle == 6'd10 | cycle == 6'd12 | cycle == 6'd13)
        assert (\dut.a_q == weight_before);
      if (cycle == 6'd1 | cycle == 6'd5) assert (\dut.b_q == weight4_before);
      if (cycle == 6'd9 | cycle == 6'd10) assert (\dut.b_q == dv);
      if (cycle == 6'd12 | cycle == 6'd13) assert (\dut.b_q == du);
      if (cycle > 6'd6) assert (mirror == (det < 0));
      assert (calibrated_valid == (cycle == 6'd13 | cycle == 6'd14));
      if (calibrated_valid) begin
        assert (calibrated_s == (cycle == 6'd14));
        assert (saturated == (word > Highest | word < Lowest));
        assert ($signed(calibrated) == (word > Highest ? Highest : word < Lowest ? Lowest : word));
      end
      if (cycle == 6'd15) assert (\dut.x_q == exact_s & \dut.y_q == exact_c & shift == 7'd0);
    end
    if (Begin != 0 & started) begin
      assert (places == 7'd0 | places == 7'd1 | places == 7'd8);
      if (places == 7'd0) assert (\dut.x_q == x_before & \dut.y_q == y_before);
      if (places == 7'd1) begin
        assert (\dut.x_q >>> 1 == x_before & \dut.y_q >>> 1 == y_before);
        assert (~\dut.x_q [0] & ~\dut.y_q [0]);
      end
      if (places == 7'd8) begin
        assert (\dut.x_q >>> 8 == x_before & \dut.y_q >>> 8 == y_before);
        assert (~|\dut.x_q [7:0] & ~|\dut.y_q [7:0]);
      end
      if (cycle == 6'd31) begin
        assert (zero == (\dut.x_q == 0 & \dut.y_q == 0));
        assert (zero | \dut.x_q [66] != \dut.x_q [65] | \dut.y_q [66] != \dut.y_q [65]);
        assert (s == \dut.x_q [66:30] & c == \dut.y_q [66:30]);
      end
    end
  end

endmodule
