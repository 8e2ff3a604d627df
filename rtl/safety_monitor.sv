// SPDX-License-Identifier: Apache-2.0
// Safety mechanisms (docs/reference/coprocessor.md): what is wrong with the sample that T4 commits.
//
//   bad_parity_i  with boundary_i: a register does not fit its parity bit; bad_safety_i: SAFETY does not
//   bad_node_i    with boundary_i: a node that T1 read does not fit its parity bit; bad_sum_i: a block's sum that T3 read
//   bad_copy_i    with boundary_i: the stages' copy of a register changed in the tick that ends
//   error_i       s32, Q1.31, with error_valid_i: an error of T3
//   step_i        s30, 2^-30 turn, with the commit: from the angle of the sample before; 0 for the first one
//   pending_i     with the commit: software has not taken the result before
//   findings_o    with the commit: MISSED, JUMP, MISFIT, PARITY, as far as they are on
// Limits and enables count as they were at the tick's start. With Present = 0 nothing is found.
module safety_monitor #(
  parameter int Present = 1
) (
  input  logic        clk_i,
  input  logic        boundary_i,
  input  capsoc_coprocessor_safety_t safety_i,
  input  logic        bad_parity_i,
  input  logic        bad_safety_i,
  input  logic        bad_node_i,
  input  logic        bad_sum_i,
  input  logic        bad_copy_i,
  input  logic        error_valid_i,
  input  logic [31:0] error_i,
  input  logic [29:0] step_i,
  input  logic        pending_i,
  output logic [3:0]  findings_o
);

  logic [3:0] enables_q;
  logic [4:0] error_limit_q, step_limit_q;
  always_ff @(posedge clk_i) begin
    if (boundary_i) begin
      enables_q <= {safety_i.MISSED, safety_i.JUMP, safety_i.MISFIT, safety_i.PARITY};
      error_limit_q <= safety_i.ERROR_LIMIT;
      step_limit_q <= safety_i.STEP_LIMIT;
    end
  end

  // A word is beyond its limit if one of the upper bits that the limit takes away is not as the sign is.
  logic [30:0] error_beyond;
  for (genvar j = 0; j < 31; j = j + 1) begin : g_error
    assign error_beyond[j] = error_limit_q > 5'(j) && error_i[30-j] != error_i[31];
  end
  logic [28:0] step_beyond;
  for (genvar j = 0; j < 29; j = j + 1) begin : g_step
    assign step_beyond[j] = step_limit_q > 5'(j) && step_i[28-j] != step_i[29];
  end

  // What T1 and T3 have read belongs to the samples that are in T2 and T4 from this boundary on.
  logic [4:0] bad_words;
  assign bad_words = {bad_sum_i, 1'b0, bad_node_i, 2'b00};

  // No reset: a tag means nothing unless its stage holds a sample.
  logic [4:0] bad_parity_q, bad_safety_q;  // of T0 to T4
  logic misfit3_q, misfit4_q;
  always_ff @(posedge clk_i) begin
    if (boundary_i) begin
      bad_parity_q <= {bad_parity_q[3:0] | {4{bad_copy_i}}, 1'b0} | {5{bad_parity_i}} | bad_words;
      bad_safety_q <= {bad_safety_q[3:0], 1'b0} | {5{bad_safety_i}};
      misfit3_q <= 1'b0;
      misfit4_q <= misfit3_q;
    end else if (error_valid_i) begin
      misfit3_q <= misfit3_q || |error_beyond;
    end
  end

  // A flip in SAFETY may have switched the mechanism off.
  assign findings_o = ((enables_q & {pending_i, |step_beyond, misfit4_q, bad_parity_q[4] | bad_copy_i}) | {3'd0, bad_safety_q[4]}) &
                      {4{Present != 0}};

  logic unused_bits;
  assign unused_bits = ^{safety_i.RESERVED_31_29, safety_i.RESERVED_23_21, safety_i.RESERVED_15_9, safety_i.BAD_PARITY,
                         safety_i.RESERVED_7_4};

endmodule
