// SPDX-License-Identifier: Apache-2.0
// Checks a tick of polar_unit.sv against docs/reference/coprocessor.md, from any state:
// - which vector goes into the CORDIC, and how it is prepared
// - that ten times three micro-rotations follow in their order
// - the resulting angles and magnitudes
// The units inside (normaliser, micro-rotation, gain) are arbitrary here (polar_stand_ins.sv) and have separate proofs.
module polar_unit_properties (
  input logic        clk_i,
  input logic [36:0] s_i, c_i,
  input logic [ 6:0] shift_i,
  input logic        zero_i,
  input logic [47:0] weight3_i, weight4_i, weight5_i
);

  // One tick, with a sample in T1, in T4, in both or in none.
  (* anyconst *) logic t1, t4;
  logic       running = 1'b0;
  logic [4:0] cycle = 5'd0;
  always @(posedge clk_i) begin
    running <= 1'b1;
    cycle   <= running ? cycle + 5'd1 : 5'd0;
  end
  logic boundary;
  assign boundary = !running || cycle == 5'd31;

  logic [31:0] relative, amplitude, a1, a2, phi, psi;
  logic        zero, amplitude_valid, t1_saturated, t4_saturated;
  polar_unit dut (
    .clk_i, .boundary_i (boundary), .t1_active_i (running && t1), .t4_active_i (running && t4), .cycle_i (cycle),
    .s_i, .c_i, .shift_i, .zero_i, .weight3_i, .weight4_i, .weight5_i,
    .relative_o (relative), .zero_o (zero), .amplitude_valid_o (amplitude_valid), .amplitude_o (amplitude),
    .a1_o (a1), .a2_o (a2), .phi_o (phi), .psi_o (psi), .t1_saturated_o (t1_saturated), .t4_saturated_o (t4_saturated)
  );

  (* hierconn *) logic        \dut.u_normaliser.active_i ;
  (* hierconn *) logic [ 4:0] \dut.u_normaliser.cycle_i ;
  (* hierconn *) logic [47:0] \dut.u_normaliser.weight3_i ;
  (* hierconn *) logic [47:0] \dut.u_normaliser.weight4_i ;
  (* hierconn *) logic [47:0] \dut.u_normaliser.weight5_i ;
  (* hierconn *) logic [36:0] \dut.u_normaliser.x_o ;
  (* hierconn *) logic [36:0] \dut.u_normaliser.y_o ;
  (* hierconn *) logic [ 6:0] \dut.u_normaliser.shift_o ;
  (* hierconn *) logic        \dut.u_normaliser.zero_o ;
  (* hierconn *) logic [ 1:0] \dut.u_step0.offset ;
  (* hierconn *) logic [ 1:0] \dut.u_step0.thirds_i ;
  (* hierconn *) logic [ 1:0] \dut.u_step0.rest_i ;
  (* hierconn *) logic [38:0] \dut.u_step0.x_i ;
  (* hierconn *) logic [38:0] \dut.u_step0.y_i ;
  (* hierconn *) logic [36:0] \dut.u_step0.z_i ;
  (* hierconn *) logic [38:0] \dut.u_step0.x_o ;
  (* hierconn *) logic [38:0] \dut.u_step0.y_o ;
  (* hierconn *) logic [36:0] \dut.u_step0.z_o ;
  (* hierconn *) logic [ 1:0] \dut.u_step1.offset ;
  (* hierconn *) logic [ 1:0] \dut.u_step1.thirds_i ;
  (* hierconn *) logic [ 1:0] \dut.u_step1.rest_i ;
  (* hierconn *) logic [38:0] \dut.u_step1.x_i ;
  (* hierconn *) logic [38:0] \dut.u_step1.y_i ;
  (* hierconn *) logic [36:0] \dut.u_step1.z_i ;
  (* hierconn *) logic [38:0] \dut.u_step1.x_o ;
  (* hierconn *) logic [38:0] \dut.u_step1.y_o ;
  (* hierconn *) logic [36:0] \dut.u_step1.z_o ;
  (* hierconn *) logic [ 1:0] \dut.u_step2.offset ;
  (* hierconn *) logic [ 1:0] \dut.u_step2.thirds_i ;
  (* hierconn *) logic [ 1:0] \dut.u_step2.rest_i ;
  (* hierconn *) logic [38:0] \dut.u_step2.x_i ;
  (* hierconn *) logic [38:0] \dut.u_step2.y_i ;
  (* hierconn *) logic [36:0] \dut.u_step2.z_i ;
  (* hierconn *) logic [38:0] \dut.u_step2.x_o ;
  (* hierconn *) logic [38:0] \dut.u_step2.y_o ;
  (* hierconn *) logic [36:0] \dut.u_step2.z_o ;
  (* hierconn *) logic        \dut.u_gain.active_i ;
  (* hierconn *) logic [38:0] \dut.u_gain.x_i ;
  (* hierconn *) logic [ 6:0] \dut.u_gain.shift_i ;
  (* hierconn *) logic [31:0] \dut.u_gain.magnitude_o ;
  (* hierconn *) logic        \dut.u_gain.saturated_o ;

  // The vector that begins in the next cycle: >>r to 35 bits and the sign, in the half plane of positive x.
  logic signed [38:0] x_word, y_word, x_rounded, y_rounded;
  logic               turned;
  assign x_word    = $signed(boundary ? c_i : \dut.u_normaliser.x_o );
  assign y_word    = $signed(boundary ? s_i : \dut.u_normaliser.y_o );
  assign x_rounded = (x_word + 39'sd1) >>> 1;
  assign y_rounded = (y_word + 39'sd1) >>> 1;
  assign turned    = x_rounded < 0;

  // Its words, from cycle to cycle, with the number of its cycle.
  logic [38:0] x, y;
  logic [36:0] z;
  logic [ 6:0] shift;
  logic        no_angle;
  logic [ 4:0] number;
  assign number = cycle < 5'd10 ? cycle : cycle < 5'd20 ? cycle - 5'd10 : cycle - 5'd20;
  always @(posedge clk_i) begin
    if (boundary || number == 5'd9) begin
      x        <= turned ? -x_rounded : x_rounded;
      y        <= turned ? -y_rounded : y_rounded;
      z        <= {turned, 36'd0};
      shift    <= boundary ? shift_i : \dut.u_normaliser.shift_o ;
      no_angle <= boundary ? zero_i : \dut.u_normaliser.zero_o ;
    end else begin
      x <= \dut.u_step2.x_o ;
      y <= \dut.u_step2.y_o ;
      z <= \dut.u_step2.z_o ;
    end
  end

  // What the last micro-rotation left, with the vector's shift, and whether that was no vector.
  logic [38:0] x_found;
  logic [31:0] angle_found, relative_due, psi_due, a2_due;
  logic [ 6:0] shift_found;
  logic        no_angle_found, zero_due;
  logic [37:0] z_rounded;
  assign z_rounded = {1'b0, \dut.u_step2.z_o } + 38'd16;
  always @(posedge clk_i) begin
    if (number == 5'd9) begin
      x_found        <= \dut.u_step2.x_o ;
      angle_found    <= no_angle ? 32'd0 : z_rounded[36:5];
      shift_found    <= shift;
      no_angle_found <= no_angle;
    end
    if (cycle == 5'd10) {relative_due, zero_due} <= {angle_found, no_angle_found};
    if (cycle == 5'd20) psi_due <= angle_found;
    if (cycle == 5'd21) a2_due <= \dut.u_gain.magnitude_o ;
  end

  logic own;  // a vector of a sample is in the CORDIC
  assign own = cycle < 5'd10 ? t1 : cycle < 5'd30 && t4;
  // The gain takes x a cycle before it gives the magnitude, and the shift with it.
  logic taken, gives;
  assign taken = (t1 && cycle == 5'd10) || (t4 && (cycle == 5'd20 || cycle == 5'd30));
  assign gives = (t1 && cycle == 5'd11) || (t4 && (cycle == 5'd21 || cycle == 5'd31));

  always @* begin
    assert (\dut.u_step0.offset == 2'd0 && \dut.u_step1.offset == 2'd1 && \dut.u_step2.offset == 2'd2);
    if (running) begin
      assert (\dut.u_normaliser.active_i == t4 && \dut.u_normaliser.cycle_i == cycle);
      assert (\dut.u_normaliser.weight3_i == weight3_i && \dut.u_normaliser.weight4_i == weight4_i &&
              \dut.u_normaliser.weight5_i == weight5_i);
      if (own) begin
        assert (\dut.u_step0.thirds_i == 2'(number / 5'd3) && \dut.u_step0.rest_i == 2'(number % 5'd3));
        assert ({\dut.u_step1.thirds_i , \dut.u_step1.rest_i } == {\dut.u_step0.thirds_i , \dut.u_step0.rest_i });
        assert ({\dut.u_step2.thirds_i , \dut.u_step2.rest_i } == {\dut.u_step0.thirds_i , \dut.u_step0.rest_i });
        assert (\dut.u_step0.x_i == x && \dut.u_step0.y_i == y && \dut.u_step0.z_i == z);
        assert (\dut.u_step1.x_i == \dut.u_step0.x_o && \dut.u_step1.y_i == \dut.u_step0.y_o &&
                \dut.u_step1.z_i == \dut.u_step0.z_o );
        assert (\dut.u_step2.x_i == \dut.u_step1.x_o && \dut.u_step2.y_i == \dut.u_step1.y_o &&
                \dut.u_step2.z_i == \dut.u_step1.z_o );
      end
      if (taken) assert (\dut.u_gain.active_i && \dut.u_gain.x_i == x_found);
      if (gives) assert (\dut.u_gain.shift_i == shift_found);
      if (t1 && cycle >= 5'd11) assert (relative == relative_due && zero == zero_due);
      assert (amplitude_valid == (t1 && cycle == 5'd11));
      if (amplitude_valid) assert (amplitude == \dut.u_gain.magnitude_o );
      if (t4 && cycle == 5'd31)
        assert (phi == angle_found && psi == psi_due && a1 == \dut.u_gain.magnitude_o && a2 == a2_due);
      assert (t1_saturated == (t1 && cycle == 5'd11 && \dut.u_gain.saturated_o ));
      assert (t4_saturated == (t4 && (cycle == 5'd21 || cycle == 5'd31) && \dut.u_gain.saturated_o ));
    end
  end

endmodule
