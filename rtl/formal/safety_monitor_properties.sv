// SPDX-License-Identifier: Apache-2.0
// Safety mechanisms: the limits as comparisons of numbers, and the tags of a sample that enters at any boundary.
module safety_monitor_properties (
  input logic        clk_i,
  input logic        boundary_i,
  input logic [31:0] word_i,        // SAFETY
  input logic        bad_parity_i,
  input logic        bad_safety_i,
  input logic        bad_node_i,
  input logic        bad_sum_i,
  input logic        bad_copy_i,
  input logic        error_valid_i,
  input logic signed [31:0] error_i,
  input logic signed [29:0] step_i,
  input logic        pending_i
);

  logic [3:0] findings;
  safety_monitor dut (
    .clk_i, .boundary_i, .safety_i (word_i), .bad_parity_i, .bad_safety_i, .bad_node_i, .bad_sum_i, .bad_copy_i, .error_valid_i, .error_i (error_i),
    .step_i (step_i), .pending_i, .findings_o (findings)
  );

  // The register as it was at the last boundary.
  logic       known;
  logic [3:0] enables;
  logic [4:0] error_limit, step_limit;
  initial known = 1'b0;
  always @(posedge clk_i) begin
    if (boundary_i) begin
      known       <= 1'b1;
      enables     <= word_i[3:0];
      error_limit <= word_i[20:16];
      step_limit  <= word_i[28:24];
    end
  end

  logic signed [32:0] error_end;  // the least error that is too large
  logic signed [30:0] step_end;
  logic misfit, jump;
  assign error_end = 33'sd1 <<< (6'd31 - error_limit);
  assign step_end  = 31'sd1 <<< (5'd29 - (step_limit > 5'd29 ? 5'd29 : step_limit));
  assign misfit    = error_i >= error_end || error_i < -error_end;
  assign jump      = step_i >= step_end || step_i < -step_end;

  // A sample that enters T0 at a boundary of the solver's choice: `age` is the stage that holds it.
  logic       enters, followed, bad, bad_safety, misfits;
  logic [2:0] age;
  (* anyseq *) logic chosen;
  assign enters = boundary_i && chosen && !followed;
  initial followed = 1'b0;
  always @(posedge clk_i) begin
    if (enters) begin
      followed   <= 1'b1;
      age        <= 3'd0;
      bad        <= bad_parity_i;
      bad_safety <= bad_safety_i;
      misfits    <= 1'b0;
    end else if (followed && boundary_i) begin
      age        <= age + 3'd1;
      followed   <= age != 3'd4;
      bad        <= bad || bad_copy_i || (bad_parity_i && age != 3'd4) || (bad_node_i && age == 3'd1) || (bad_sum_i && age == 3'd3);
      bad_safety <= bad_safety || (bad_safety_i && age != 3'd4);
    end else if (followed && age == 3'd3 && error_valid_i) begin
      misfits    <= misfits || misfit;
    end
  end

  // Where the tags of that sample are, for the induction.
  (* hierconn *) logic [4:0] \dut.bad_parity_q ;
  (* hierconn *) logic [4:0] \dut.bad_safety_q ;
  (* hierconn *) logic \dut.misfit3_q ;
  (* hierconn *) logic \dut.misfit4_q ;
  (* hierconn *) logic [3:0] \dut.enables_q ;
  (* hierconn *) logic [4:0] \dut.error_limit_q ;
  (* hierconn *) logic [4:0] \dut.step_limit_q ;
  always @* begin
    if (known) begin
      assert (\dut.enables_q == enables && \dut.error_limit_q == error_limit && \dut.step_limit_q == step_limit);
    end
    if (followed) begin
      assert (age <= 3'd4);
      assert (known);
      assert (\dut.bad_parity_q [age] == bad);
      assert (\dut.bad_safety_q [age] == bad_safety);
      if (age < 3'd3) assert (!misfits);
      if (age == 3'd3) assert (\dut.misfit3_q == misfits);
      if (age == 3'd4) assert (\dut.misfit4_q == misfits);
      if (age == 3'd4) assert (findings == ((enables & {pending_i, jump, misfits, bad || bad_copy_i}) | {3'd0, bad_safety}));
    end
  end

endmodule
