// SPDX-License-Identifier: Apache-2.0
// Reads STATUS of the coprocessor at intervals for lamps, between the transfers of another manager of the same APB.
//
// Latency: a transfer of the manager is passed on in the same clock, and waits up to two clocks for a read of STATUS.
// Formats: status_o is the last word of STATUS, at most Interval and three clocks old while the manager leaves gaps.
// A read of STATUS has no side effect, so that the manager sees no difference but the wait. With several channels that
// is not so (CHANNEL.REFUSED); this reader is for a coprocessor with one.
module capsoc_status_reader #(
  parameter int Interval = 65536  // clocks between two reads, at least 4
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  // APB of the manager
  input  logic        psel_i,
  input  logic        penable_i,
  input  logic        pwrite_i,
  input  logic [11:0] paddr_i,
  input  logic [3:0]  pstrb_i,
  output logic        pready_o,
  // APB of the coprocessor; PWDATA, PRDATA and PSLVERR go past
  output logic        psel_o,
  output logic        penable_o,
  output logic        pwrite_o,
  output logic [11:0] paddr_o,
  output logic [3:0]  pstrb_o,
  input  logic        pready_i,
  input  logic [31:0] prdata_i,
  output logic [31:0] status_o
);

  localparam int Width = $clog2(Interval);
  localparam logic [Width-1:0] Last = Width'(Interval - 1);
  localparam logic [11:0] Status = 12'h00C;

  logic [Width-1:0] clocks_q;
  logic             due_q, reading_q, enable_q, late_q;
  logic [31:0]      status_q;
  logic             begins, ends;

  assign begins = due_q && !reading_q && !psel_i;
  assign ends   = reading_q && enable_q && pready_i;

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      clocks_q  <= '0;
      due_q     <= 1'b0;
      reading_q <= 1'b0;
      enable_q  <= 1'b0;
      late_q    <= 1'b0;
      status_q  <= '0;
    end else begin
      clocks_q <= clocks_q == Last ? '0 : clocks_q + 1'b1;
      due_q    <= clocks_q == Last || (due_q && !begins);
      if (begins) reading_q <= 1'b1;
      enable_q <= reading_q && !ends;
      if (ends) begin
        reading_q <= 1'b0;
        status_q  <= prdata_i;
      end
      // A transfer that began meanwhile still needs its setup phase at the coprocessor.
      late_q <= reading_q && psel_i;
    end
  end

  assign psel_o    = reading_q || psel_i;
  assign penable_o = reading_q ? enable_q : penable_i && !late_q;
  assign pwrite_o  = reading_q ? 1'b0 : pwrite_i;
  assign paddr_o   = reading_q ? Status : paddr_i;
  assign pstrb_o   = reading_q ? 4'd0 : pstrb_i;
  assign pready_o  = pready_i && !late_q;  // late_q also in the access phase that meets a read of STATUS
  assign status_o  = status_q;

endmodule
