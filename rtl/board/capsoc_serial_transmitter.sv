// SPDX-License-Identifier: Apache-2.0
// Transmitter of a serial line (8N1): one start bit, eight data bits from bit 0 on, no parity, one stop bit.
//
// Latency: the start bit begins at the clock edge that takes the byte; ready_o is 1 again 10 ClocksPerBit clocks later.
// Formats: ClocksPerBit is the clock's rate over the line's, at least 2. serial_o is a register and idle at 1.
module capsoc_serial_transmitter #(
  parameter int ClocksPerBit = 217
) (
  input  logic       clk_i,
  input  logic       rst_ni,
  input  logic       valid_i,
  input  logic [7:0] data_i,
  output logic       ready_o,  // a byte of this interval is taken
  output logic       serial_o
);

  localparam int Width = $clog2(ClocksPerBit);
  localparam logic [Width-1:0] Last = Width'(ClocksPerBit - 1);

  logic [Width-1:0] clocks_q;
  logic [3:0]       left_q;   // bits of the byte that have not ended
  logic [8:0]       shift_q;  // bit 0 is on the line

  assign ready_o  = left_q == '0;
  assign serial_o = shift_q[0];

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      clocks_q <= '0;
      left_q   <= '0;
      shift_q  <= '1;
    end else if (ready_o) begin
      clocks_q <= '0;
      if (valid_i) begin
        left_q  <= 4'd10;
        shift_q <= {data_i, 1'b0};
      end
    end else if (clocks_q == Last) begin
      clocks_q <= '0;
      left_q   <= left_q - 1'b1;
      shift_q  <= {1'b1, shift_q[8:1]};
    end else begin
      clocks_q <= clocks_q + 1'b1;
    end
  end

endmodule
