// SPDX-License-Identifier: Apache-2.0
// The APB slave (register_bank.sv): its answers, and that only a correct access has an effect.
// `quiet` is 1 in an interval whose edge must change nothing: scripts/tool formal then asserts of every
// register of the bank that it keeps its value.
module apb_properties (
  input logic        clk_i,
  input logic        psel_i, penable_i, pwrite_i,
  input logic [11:0] paddr_i,
  input logic [31:0] pwdata_i,
  input logic [3:0]  pstrb_i,
  input logic        busy_i, busy_next_i, stream_early_i, soft_early_i, boundary_i,
  input state_we_t   state_we_i,
  input state_t      state_i,
  input logic        commit_i,
  input flags_t      flags_i,
  input status_t     status_i,
  input logic [31:0] turn_flags_i,
  input logic [31:0] result_i
);

  logic in_reset = 1'b1;
  always @(posedge clk_i) in_reset <= 1'b0;

  logic        pready, pslverr, irq, clear, adc_enable, soft_valid, load, frozen;
  logic [31:0] prdata, soft_u;
  logic [3:0]  result_select;
  settings_t   settings;
  correction_t correction;
  state_t      state;
  register_bank dut (
    .clk_i, .rst_ni (~in_reset),
    .psel_i, .penable_i, .pwrite_i, .paddr_i, .pwdata_i, .pstrb_i,
    .pready_o (pready), .prdata_o (prdata), .pslverr_o (pslverr), .irq_o (irq),
    .clear_o (clear), .adc_enable_o (adc_enable), .soft_valid_o (soft_valid), .soft_u_o (soft_u),
    .load_o (load), .busy_i, .busy_next_i, .stream_early_i, .soft_early_i,
    .settings_o (settings), .correction_o (correction), .frozen_o (frozen),
    .state_o (state), .boundary_i, .state_we_i, .state_i,
    .commit_i, .flags_i, .status_i, .turn_flags_i,
    .result_select_o (result_select), .result_i
  );

  // The map as the document lists it.
  logic [9:0] word;
  logic       listed, access, error, pair_high;
  assign word      = paddr_i[11:2];
  assign listed    = paddr_i[1:0] == 2'd0 & word <= 10'h03F & word != 10'h03A;
  assign access    = psel_i & penable_i;
  assign error     = ~listed | (pwrite_i & pstrb_i != 4'hF);
  assign pair_high = word == 10'h007 | word == 10'h009 |
                     (word >= 10'h014 & word <= 10'h01F & word[0]);

  // Silent: no transfer, a setup phase, an access that ends in an error, a read without a latch, a
  // write to a read-only register; and neither a tick's boundary nor a lost sample.
  logic read_only;
  (* keep *) logic quiet;
  assign read_only = word == 10'h000 | word == 10'h001 | word == 10'h003 | word == 10'h013 |
                     (word >= 10'h02C & word <= 10'h03F);
  assign quiet     = ~in_reset & ~boundary_i & ~stream_early_i & ~soft_early_i &
                     (~access | error | (pwrite_i ? read_only : ~pair_high));

  always @* if (~in_reset) begin
    assert (pready);
    assert (pslverr == (access & error));
    if (~listed) assert (prdata == 32'd0);
    if (~access | error | ~pwrite_i) assert (~clear & ~soft_valid & ~load);
    if (soft_valid) assert (paddr_i == capsoc_coprocessor_pkg::SOFT_V_OFFSET);
    if (load) assert (paddr_i == capsoc_coprocessor_pkg::CMD_OFFSET & pwdata_i[capsoc_coprocessor_pkg::CMD_LOAD_LSB]);
    if (correction.write) assert (access & pwrite_i & ~error & paddr_i == capsoc_coprocessor_pkg::CORRECTION_OFFSET);
    if (clear) assert (paddr_i == capsoc_coprocessor_pkg::CTRL_OFFSET & pwdata_i[capsoc_coprocessor_pkg::CTRL_SRST_LSB]);
    if (access & pwrite_i & ~error & paddr_i == capsoc_coprocessor_pkg::SOFT_V_OFFSET) assert (soft_valid);
    if (access & pwrite_i & ~error & paddr_i == capsoc_coprocessor_pkg::CMD_OFFSET) assert (load == pwdata_i[capsoc_coprocessor_pkg::CMD_LOAD_LSB]);
    if (access & pwrite_i & ~error & paddr_i == capsoc_coprocessor_pkg::CTRL_OFFSET) assert (clear == pwdata_i[capsoc_coprocessor_pkg::CTRL_SRST_LSB]);
  end

endmodule
