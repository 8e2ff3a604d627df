// SPDX-License-Identifier: Apache-2.0
// FLAGS and the interrupt line (docs/reference/coprocessor.md, "Commit", "Registers").
//
// Latency: a flag is set at the edge of its event. Clearing wins over setting at one edge, because
// the register access is the last thing that happens there.
module flag_register #(
  parameter int Safety = 1,         // the flags of the safety mechanisms are there
  parameter int Channels = 1
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        clear_i,      // soft reset
  input  logic [15:0] set_i,        // events of this edge, in FLAGS' order
  input  logic        write_i,      // bus write: ones clear
  input  logic [15:0] write_data_i,
  input  enables_t    enables_i,
  input  logic        early_i,      // EARLY, set elsewhere
  output logic [15:0] flags_o,
  output logic        irq_o,
  input  logic               shift_i,
  input  chain_t      chain_i,
  output chain_t      chain_o
);

  localparam logic [15:0] SafetyFlags = 16'hF << capsoc_coprocessor_pkg::FLAGS_PARITY_LSB;
  logic [15:0] flags_q, flags_d;

  logic shift;
  logic [15:0] moved;
  assign shift = Channels > 1 && shift_i;
  context_chain #(.Channels(Channels), .Width(16)) u_chain (
    .kept_i(flags_q), .chain_i, .moved_o(moved), .chain_o
  );

  always_comb begin
    flags_d = flags_q | set_i;
    if (write_i) flags_d = flags_d & ~write_data_i;
    if (clear_i) flags_d = '0;
    flags_d = flags_d & ~(Safety != 0 ? 16'd0 : SafetyFlags);
  end

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) flags_q <= '0;
    else flags_q <= shift & ~clear_i ? moved : flags_d;
  end

  localparam logic [15:0] Result  = 16'd1 << capsoc_coprocessor_pkg::FLAGS_RESULT_LSB;
  localparam logic [15:0] Lock    = 16'd1 << capsoc_coprocessor_pkg::FLAGS_LOCKCHG_LSB;
  localparam logic [15:0] Mirror  = 16'd1 << capsoc_coprocessor_pkg::FLAGS_MIRRORCHG_LSB;
  localparam logic [15:0] Turn    = 16'd1 << capsoc_coprocessor_pkg::FLAGS_TURN_LSB;
  localparam logic [15:0] Alarm   = 16'd1 << capsoc_coprocessor_pkg::FLAGS_ALARM_LSB;
  localparam logic [15:0] Trouble = ~(Result | Lock | Mirror | Turn | Alarm | SafetyFlags);

  logic own_irq, early;
  assign early   = Channels > 1 & early_i;
  assign flags_o = flags_q | {11'd0, early, 4'd0};
  assign irq_o   = own_irq | (enables_i.error & early);
  assign own_irq = (enables_i.result & (|(flags_q & Result))) | (enables_i.lock & (|(flags_q & Lock))) |
                   (enables_i.error & (|(flags_q & Trouble))) | (enables_i.turn & (|(flags_q & Turn))) |
                   (enables_i.alarm & (|(flags_q & Alarm))) | (enables_i.safety & (|(flags_q & SafetyFlags)));

endmodule
