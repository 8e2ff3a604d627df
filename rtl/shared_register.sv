// SPDX-License-Identifier: Apache-2.0
// A register that both software and the pipeline write, with a parity bit. At one edge a soft reset wins over the bus
// and the bus over the pipeline (docs/reference/coprocessor.md, "Order at one edge").
//
// Latency: one edge. The register knows no format. fault_o, with boundary_i: the word does not fit its parity bit.
module shared_register #(
  parameter int                 Width      = 32,
  parameter logic [Width - 1:0] ResetValue = '0,
  parameter int                 Safety     = 1,   // the parity bit is there
  parameter int                 Channels   = 1
) (
  input  logic               clk_i,
  input  logic               rst_ni,
  input  logic               clear_i,
  input  logic               bus_we_i,
  input  logic [Width - 1:0] bus_i,
  input  logic               bus_parity_i,
  input  logic               pipeline_we_i,
  input  logic [Width - 1:0] pipeline_i,
  input  logic               boundary_i,
  output logic [Width - 1:0] q_o,
  output logic               fault_o,
  input  logic               shift_i,
  input  chain_t             chain_i,
  output chain_t             chain_o
);

  localparam logic ResetParity = Safety != 0 & (^ResetValue);
  logic [Width - 1:0] value_q;
  logic parity_q;

  logic shift;
  logic [Width:0] moved;
  assign shift = Channels > 1 && shift_i;
  context_chain #(.Channels(Channels), .Width(Width + 1)) u_chain (
    .kept_i({parity_q, value_q}), .chain_i, .moved_o(moved), .chain_o
  );

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      value_q  <= ResetValue;
      parity_q <= ResetParity;
    end else if (clear_i | bus_we_i | pipeline_we_i) begin
      value_q  <= clear_i ? ResetValue : bus_we_i ? bus_i : pipeline_i;
      parity_q <= clear_i ? ResetParity : Safety != 0 & (bus_we_i ? bus_parity_i : ^pipeline_i);
    end else if (shift) begin
      {parity_q, value_q} <= moved;
    end
  end

  assign q_o     = value_q;
  assign fault_o = boundary_i ? Safety != 0 & (parity_q ^ (^value_q)) : 1'b0;

endmodule
