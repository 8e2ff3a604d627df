// SPDX-License-Identifier: Apache-2.0
// Receiver of an asynchronous serial line: one start bit, eight data bits from bit 0 on, no parity, one stop bit (8N1).
//
// Latency: a byte or a framing error is out half a bit after the stop bit begins, and two clocks for the synchroniser.
// Formats: ClocksPerBit is the clock's rate over the line's, at least 4. serial_i is idle at 1, and asynchronous.
// Each bit is sampled in its middle. A start bit that is 1 again in its middle is noise, and nothing is received.
// A stop bit of 0 is a framing error: the byte is lost, and the next start bit counts after the line was 1 again.
module capsoc_serial_receiver #(
  parameter int ClocksPerBit = 217
) (
  input  logic       clk_i,
  input  logic       rst_ni,
  input  logic       serial_i,
  output logic       valid_o,  // one clock: data_o is a byte that was received
  output logic [7:0] data_o,
  output logic       error_o,  // one clock: a framing error
  output logic       busy_o    // a byte is on the line, or the line is 0
);

  localparam int Width = $clog2(ClocksPerBit);
  localparam logic [Width-1:0] Last   = Width'(ClocksPerBit - 1);
  localparam logic [Width-1:0] Middle = Width'(ClocksPerBit / 2 - 1);

  localparam logic [1:0] Idle  = 2'd0;
  localparam logic [1:0] Start = 2'd1;
  localparam logic [1:0] Data  = 2'd2;  // and the stop bit, bit 8
  localparam logic [1:0] Break = 2'd3;  // after a framing error, until the line is 1

  logic [1:0]       line_q;  // synchroniser
  logic [1:0]       state_q;
  logic [Width-1:0] clocks_q;
  logic [3:0]       bit_q;
  logic [7:0]       data_q;
  logic             line, valid_q, error_q;

  assign line = line_q[1];

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) line_q <= 2'b11;
    else line_q <= {line_q[0], serial_i};
  end

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      state_q  <= Idle;
      clocks_q <= '0;
      bit_q    <= '0;
      data_q   <= '0;
      valid_q  <= 1'b0;
      error_q  <= 1'b0;
    end else begin
      valid_q <= 1'b0;
      error_q <= 1'b0;
      case (state_q)
        Idle: begin
          clocks_q <= '0;
          bit_q    <= '0;
          if (!line) state_q <= Start;
        end
        Start: begin
          clocks_q <= clocks_q + 1'b1;
          if (clocks_q == Middle) begin
            clocks_q <= '0;
            state_q  <= line ? Idle : Data;
          end
        end
        Data: begin
          clocks_q <= clocks_q + 1'b1;
          if (clocks_q == Last) begin
            clocks_q <= '0;
            bit_q    <= bit_q + 1'b1;
            if (bit_q == 4'd8) begin
              valid_q <= line;
              error_q <= !line;
              state_q <= line ? Idle : Break;
            end else begin
              data_q <= {line, data_q[7:1]};
            end
          end
        end
        default: if (line) state_q <= Idle;
      endcase
    end
  end

  assign valid_o = valid_q;
  assign data_o  = data_q;
  assign error_o = error_q;
  assign busy_o  = state_q != Idle;

endmodule
