// SPDX-License-Identifier: Apache-2.0
// AHB-Lite subordinate (Arm IHI 0033A) that makes one APB transfer (IHI 0024C) of each of its transfers. One clock for both.
//
// Latency: one wait state, and those of PREADY; an ERROR takes two cycles, the last of which ends it. IDLE and BUSY take none.
// Lanes: PADDR is the address of the word; PSTRB has the lanes that HSIZE and HADDR name, and is 0 in reads. A transfer wider
// than the bus, or not aligned to its size, is answered by ERROR without an APB transfer.
// HBURST, HPROT and HMASTLOCK are not ports: each beat brings its address, and the coprocessor has no use for the others.
// PWDATA is HWDATA, which the manager keeps while HREADYOUT is low. HRDATA is PRDATA.
module capsoc_ahb_lite_to_apb (
  input  logic        hclk_i,
  input  logic        hresetn_i,
  // AHB-Lite
  input  logic        hsel_i,
  input  logic [11:0] haddr_i,
  input  logic        hwrite_i,
  input  logic [1:0]  htrans_i,
  input  logic [2:0]  hsize_i,
  input  logic        hready_i,     // of the bus: the transfer before this one ends
  input  logic [31:0] hwdata_i,
  output logic        hreadyout_o,
  output logic [31:0] hrdata_o,
  output logic        hresp_o,
  // APB
  output logic        psel_o,
  output logic        penable_o,
  output logic        pwrite_o,
  output logic [11:0] paddr_o,
  output logic [31:0] pwdata_o,
  output logic [3:0]  pstrb_o,
  input  logic        pready_i,
  input  logic [31:0] prdata_i,
  input  logic        pslverr_i
);

  localparam logic [1:0] Idle   = 2'd0;
  localparam logic [1:0] Setup  = 2'd1;
  localparam logic [1:0] Access = 2'd2;
  localparam logic [1:0] Failed = 2'd3;  // the second cycle of an ERROR

  logic [1:0] state_q, state_d;
  logic       write_q, refused_q, refused, accept, ends, fails;
  logic [9:0] word_q;
  logic [3:0] lanes_q, lanes;

  // The address phase
  assign accept = hsel_i & hready_i & htrans_i[1];
  always_comb begin
    case (hsize_i)
      3'd0: begin
        lanes   = 4'b0001 << haddr_i[1:0];
        refused = 1'b0;
      end
      3'd1: begin
        lanes   = haddr_i[1] ? 4'b1100 : 4'b0011;
        refused = haddr_i[0];
      end
      default: begin
        lanes   = 4'b1111;
        refused = hsize_i != 3'd2 || haddr_i[1:0] != 2'd0;
      end
    endcase
  end

  // The data phase
  assign fails = (state_q == Setup && refused_q) || (state_q == Access && pready_i && pslverr_i);
  assign ends  = state_q == Idle || state_q == Failed || (state_q == Access && pready_i && !pslverr_i);
  always_comb begin
    if (fails) state_d = Failed;
    else if (ends) state_d = accept ? Setup : Idle;
    else state_d = Access;
  end

  always_ff @(posedge hclk_i or negedge hresetn_i) begin
    if (!hresetn_i) begin
      state_q   <= Idle;
      write_q   <= 1'b0;
      refused_q <= 1'b0;
      word_q    <= '0;
      lanes_q   <= '0;
    end else begin
      state_q <= state_d;
      if (ends && accept) begin
        write_q   <= hwrite_i;
        refused_q <= refused;
        word_q    <= haddr_i[11:2];
        lanes_q   <= lanes;
      end
    end
  end

  assign hreadyout_o = ends;
  assign hresp_o     = fails || state_q == Failed;
  assign hrdata_o    = prdata_i;

  assign psel_o    = (state_q == Setup && !refused_q) || state_q == Access;
  assign penable_o = state_q == Access;
  assign pwrite_o  = write_q;
  assign paddr_o   = {word_q, 2'b00};
  assign pwdata_o  = hwdata_i;
  assign pstrb_o   = lanes_q & {4{write_q}};

  logic unused_trans;  // what tells SEQ from NONSEQ, and BUSY from IDLE
  assign unused_trans = htrans_i[0];

endmodule
