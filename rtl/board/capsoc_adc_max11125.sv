// SPDX-License-Identifier: Apache-2.0
// SPI controller of the converter MAX11125 or MAX11123 (12 bits, single-ended): pairs of samples at a fixed rate.
// Source: data sheet MAX11120-MAX11128, ADC mode control register and manual (external clock) mode.
//
// Latency: sample_valid_o is 144 HalfClocks clocks after the pair begins, which is every SampleClocks clocks.
// The second signal is taken a frame, 36 HalfClocks clocks, after the first.
// Formats: a code has 12 bits, offset binary; 0 is 0 V and 2048 half of the reference. Its Q1.31 word is
// (code - 2048) 2^20, that of an ideal converter of 12 bits in the model (models/peripherals/quantiser.h).
// sample_clip_o: a code is 0 or 4095.
//
// A frame has 16 bits, most significant first, with SCLK idle at 1. Both sides change data at its fall and take them at
// its rise. A command selects the next channel: 0, SCAN = 0001 (manual), CHSEL, RESET = 00, PM = 00, CHAN_ID = 1,
// SWCNV = 1, 0. An answer is the channel's number (4 bits) and the code (12). It comes one frame after its command.
//
// A pair takes four frames, with the commands U, V, Rest, Rest. Rest is a channel between pairs: its number tells an
// old result from a new one. The answers after the first frame have to be U, V, Rest; or Rest, U, V, if the converter
// answers a frame later. Any other number makes refused_o 1 and gives no sample, and so does every pair if two of the
// three channels are the same one, for then numbers tell nothing. After a reset two frames reset the
// converter, and a third selects Rest.
module capsoc_adc_max11125 #(
  parameter int SampleClocks = 100000,  // clocks between two pairs; below Least it is Least
  parameter int HalfClocks   = 2,       // clocks of half a period of SCLK: at 25 MHz and 2, 6.25 MHz; at least 1
  parameter int ChannelU     = 0,       // AIN0, sine
  parameter int ChannelV     = 1,       // AIN1, cosine
  parameter int ChannelRest  = 7        // another one
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  // Converter
  output logic        csn_o,
  output logic        sclk_o,
  output logic        mosi_o,
  input  logic        miso_i,
  // One clock each
  output logic        sample_valid_o,
  output logic [31:0] sample_u_o,
  output logic [31:0] sample_v_o,
  output logic        sample_clip_o,
  output logic        refused_o
);

  // Halves of SCLK in a frame: CS falls, 16 falls and rises, CS rises, and three until the next frame.
  localparam logic [5:0] CsRises  = 6'd33;
  localparam logic [5:0] LastHalf = 6'd35;
  // Frames
  localparam logic [2:0] Settle  = 3'd2;  // after two that reset; its answer counts for nothing
  localparam logic [2:0] First   = 3'd3;  // of a pair
  localparam logic [2:0] Last    = 3'd6;
  localparam logic [2:0] Waiting = 3'd7;

  localparam int Least = 4 * 36 * HalfClocks + 2;
  localparam int Period = SampleClocks < Least ? Least : SampleClocks;
  localparam int PeriodWidth = $clog2(Period);
  localparam int HalfWidth = $clog2(HalfClocks + 1);
  localparam logic [PeriodWidth-1:0] PeriodEnd = PeriodWidth'(Period - 1);
  localparam logic [HalfWidth-1:0] HalfEnd = HalfWidth'(HalfClocks - 1);
  localparam logic [3:0] U    = 4'(ChannelU);
  localparam logic [3:0] V    = 4'(ChannelV);
  localparam logic [3:0] Rest = 4'(ChannelRest);
  localparam logic Distinct = U != V && U != Rest && V != Rest;

  logic [PeriodWidth-1:0] period_q;
  logic [HalfWidth-1:0]   clocks_q;
  logic [5:0]             half_q;
  logic [2:0]             frame_q;
  logic                   csn_q, sclk_q, mosi_q;
  logic [14:0]            command_q;  // the bits after the one on MOSI
  logic [15:0]            answer_q, command;
  logic                   due, half_ends, frame_ends;
  logic [3:0]             number;
  logic [11:0]            code;

  assign due        = period_q == PeriodEnd;
  assign half_ends  = clocks_q == HalfEnd && frame_q != Waiting;
  assign frame_ends = half_ends && half_q == LastHalf;

  // The command of the frame that begins
  always_comb begin
    case (frame_q)
      3'd0, 3'd1: command = {1'b0, 4'd0, 4'd0, 2'b10, 2'd0, 1'b0, 1'b0, 1'b0};  // resets all registers
      First:      command = {1'b0, 4'd1, U, 2'd0, 2'd0, 1'b1, 1'b1, 1'b0};
      3'd4:       command = {1'b0, 4'd1, V, 2'd0, 2'd0, 1'b1, 1'b1, 1'b0};
      default:    command = {1'b0, 4'd1, Rest, 2'd0, 2'd0, 1'b1, 1'b1, 1'b0};
    endcase
  end

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      period_q  <= '0;
      clocks_q  <= '0;
      half_q    <= '0;
      frame_q   <= '0;
      csn_q     <= 1'b1;
      sclk_q    <= 1'b1;
      mosi_q    <= 1'b0;
      command_q <= '0;
      answer_q  <= '0;
    end else begin
      period_q <= due ? '0 : period_q + 1'b1;
      if (frame_q == Waiting) begin
        if (due) frame_q <= First;
      end else begin
        clocks_q <= half_ends ? '0 : clocks_q + 1'b1;
        if (half_ends) half_q <= frame_ends ? '0 : half_q + 1'b1;
        if (frame_ends) frame_q <= frame_q == Settle || frame_q == Last ? Waiting : frame_q + 1'b1;
        if (clocks_q == '0) begin
          if (half_q == 6'd0) begin
            csn_q     <= 1'b0;
            mosi_q    <= command[15];
            command_q <= command[14:0];
          end else if (half_q < CsRises) begin
            sclk_q <= !half_q[0];
            if (half_q[0] && half_q != 6'd1) begin
              mosi_q    <= command_q[14];
              command_q <= {command_q[13:0], 1'b0};
            end
            // What has been there since the fall
            if (!half_q[0]) answer_q <= {answer_q[14:0], miso_i};
          end else begin
            csn_q <= 1'b1;
          end
        end
      end
    end
  end

  assign csn_o  = csn_q;
  assign sclk_o = sclk_q;
  assign mosi_o = mosi_q;

  // The answers of a pair
  localparam logic [1:0] WantsU    = 2'd0;
  localparam logic [1:0] WantsV    = 2'd1;
  localparam logic [1:0] Complete  = 2'd2;
  localparam logic [1:0] Wrong     = 2'd3;

  logic [1:0]  pair_q, pair_next;
  logic [11:0] u_q, v_q;
  logic        valid_q, refused_q;

  assign number = answer_q[15:12];
  assign code   = answer_q[11:0];

  always_comb begin
    pair_next = Wrong;
    case (pair_q)
      WantsU:   if (number == U) pair_next = WantsV;
                else if (number == Rest && frame_q == First + 3'd1) pair_next = WantsU;
      WantsV:   if (number == V) pair_next = Complete;
      Complete: if (number == Rest) pair_next = Complete;
      default:  pair_next = Wrong;
    endcase
  end

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      pair_q    <= WantsU;
      u_q       <= '0;
      v_q       <= '0;
      valid_q   <= 1'b0;
      refused_q <= 1'b0;
    end else begin
      valid_q   <= 1'b0;
      refused_q <= 1'b0;
      if (frame_q == First) pair_q <= WantsU;
      else if (frame_ends && frame_q > First) begin
        pair_q <= pair_next;
        if (pair_q == WantsU) u_q <= code;
        if (pair_q == WantsV) v_q <= code;
        if (frame_q == Last) begin
          valid_q   <= Distinct && pair_next == Complete;
          refused_q <= !Distinct || pair_next != Complete;
        end
      end
    end
  end

  assign sample_valid_o = valid_q;
  assign sample_u_o     = {~u_q[11], u_q[10:0], 20'd0};
  assign sample_v_o     = {~v_q[11], v_q[10:0], 20'd0};
  assign sample_clip_o  = u_q == '0 || u_q == '1 || v_q == '0 || v_q == '1;
  assign refused_o      = refused_q;

endmodule
