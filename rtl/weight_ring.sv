// The tick's own copy of the six weights, as a ring: whoever needs a weight waits until it comes
// past a tap, which costs one multiplexer in place of one for each reader.
//
// Formats: weights s48, Q2.46; offsets s32, Q1.31.
// At home (cycles 0 and 26 to 31) place 0..5 holds a_u, b_u, c_u, a_v, b_v, c_v. The ring turns by
// one place (place i takes place i + 1) at the end of cycles
//   0 1 3 4 5 7       the estimate: place 0 is a_u, b_u, c_u (2 and 3), a_v, b_v, c_v (6 and 7)
//   8 .. 13           the calibrator's products
//   16 18 19 22 24 25 the update: the word that leaves place 0 may be replaced by word_i
// A LOAD begins with zeros and the offset, << 15, in place of the weights that it makes.
module weight_ring (
  input  logic        clk_i,
  input  logic        boundary_i,
  input  logic        active_i,       // a tick runs
  input  logic [4:0]  cycle_i,
  input  logic        keep_u_i,       // with boundary_i: u's weights are this tick's results
  input  logic        keep_v_i,
  input  logic        load_u_i,       // with boundary_i: L1 begins
  input  logic        load_v_i,       // with boundary_i: L2 begins
  input  logic [31:0] b1_i,
  input  logic [31:0] b2_i,
  input  weights_t    weights_i,
  input  logic        replace_i,
  input  logic [47:0] word_i,
  output logic        turn_o,
  output weights_t    weights_o      // the places, each under the name of the weight that is at home there
);

  logic [47:0] place0_q, place1_q, place2_q, place3_q, place4_q, place5_q;

  //                                      cycle 31 ...                 ... cycle 0
  localparam logic [31:0] TurnInCycle = 32'b0000_0011_0100_1101_0011_1111_1011_1011;
  logic turn;
  assign turn = active_i && TurnInCycle[cycle_i];
  assign turn_o = turn;

  // What a tick begins with.
  logic [47:0] start0, start1, start2, start3, start4, start5;
  assign start0 = load_u_i ? '0 : weights_i.au;
  assign start1 = load_u_i ? '0 : weights_i.bu;
  assign start2 = load_u_i ? {b1_i[31], b1_i, 15'b0} : weights_i.cu;
  assign start3 = load_v_i ? '0 : weights_i.av;
  assign start4 = load_v_i ? '0 : weights_i.bv;
  assign start5 = load_v_i ? {b2_i[31], b2_i, 15'b0} : weights_i.cv;

  // No reset: every tick begins with a load.
  always_ff @(posedge clk_i) begin
    if (boundary_i) begin
      if (!keep_u_i) begin
        place0_q <= start0;
        place1_q <= start1;
        place2_q <= start2;
      end
      if (!keep_v_i) begin
        place3_q <= start3;
        place4_q <= start4;
        place5_q <= start5;
      end
    end else if (turn) begin
      place0_q <= place1_q;
      place1_q <= place2_q;
      place2_q <= place3_q;
      place3_q <= place4_q;
      place4_q <= place5_q;
      place5_q <= replace_i ? word_i : place0_q;
    end
  end

  assign weights_o.au = place0_q;
  assign weights_o.bu = place1_q;
  assign weights_o.cu = place2_q;
  assign weights_o.av = place3_q;
  assign weights_o.bv = place4_q;
  assign weights_o.cv = place5_q;

endmodule
