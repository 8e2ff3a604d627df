// SPDX-License-Identifier: Apache-2.0
// What an APB requester must do (Arm IHI 0024C), and a completer that answers as it likes within MaxWaits cycles.
// Clauses in brackets; their content is given in our words.
module apb_requester_rules #(
  parameter int MaxWaits = 2
) (
  input logic        clk_i, in_reset_i,
  input logic        psel_i, penable_i, pwrite_i, pready_i,
  input logic [11:0] paddr_i,
  input logic [31:0] pwdata_i,
  input logic [3:0]  pstrb_i
);

  logic        was_setup = 1'b0, was_waiting = 1'b0, pwrite_q;
  logic [11:0] paddr_q;
  logic [31:0] pwdata_q;
  logic [3:0]  pstrb_q;
  logic [1:0]  waits = 2'd0;
  always @(posedge clk_i) begin
    was_setup   <= ~in_reset_i & psel_i & ~penable_i;
    was_waiting <= ~in_reset_i & psel_i & penable_i & ~pready_i;
    waits       <= ~in_reset_i & psel_i & penable_i & ~pready_i ? waits + 2'd1 : 2'd0;
    {pwrite_q, paddr_q, pwdata_q, pstrb_q} <= {pwrite_i, paddr_i, pwdata_i, pstrb_i};
  end

  always @* begin
    assume (waits < MaxWaits | pready_i);
    if (in_reset_i) assert (~psel_i);
    if (~in_reset_i) begin
      // [4.1] SETUP lasts one cycle and ACCESS follows it; ACCESS lasts until PREADY, and SETUP or IDLE follows it.
      assert (penable_i == (was_setup | was_waiting));
      if (penable_i) assert (psel_i);
      // [3.1, 3.3, 4.1] Address, direction, data and strobes stay from SETUP to the end of ACCESS.
      if (was_setup | was_waiting) begin
        assert (pwrite_i == pwrite_q & paddr_i == paddr_q & pstrb_i == pstrb_q);
        if (pwrite_i) assert (pwdata_i == pwdata_q);
      end
      // [3.2] No strobe in a read.
      if (psel_i & ~pwrite_i) assert (pstrb_i == 4'd0);
      assert (waits <= MaxWaits);
    end
  end

endmodule
