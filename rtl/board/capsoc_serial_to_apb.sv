// SPDX-License-Identifier: Apache-2.0
// Commands of a serial line as APB transfers (IHI 0024C). Each command has one answer; the host waits for it.
//
//   host        answer              words and addresses: most significant byte first
//   R a a       r d d d d           reads the register at byte address a
//   W a a d d d d   w               writes it
//   S           s d d d d           word_i, which is no register
//   anything else   e c             c = 1: no such register, or the transfer ended with PSLVERR; 2: unknown command;
//                                   3: framing error; 4: a byte came before the answer was over
//
// Latency: an APB transfer begins one clock after the command's last byte; the answer's first byte follows its end.
// After the errors 2, 3 and 4 the rest of the burst is ignored, so that no data byte is taken for a command. The answer
// comes when the line has been idle for QuietClocks clocks; from then on the next command is taken. A command that is
// not complete after QuietClocks clocks without a byte is dropped without an answer.
module capsoc_serial_to_apb #(
  parameter int QuietClocks = 262144
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  // Receiver
  input  logic        rx_valid_i,
  input  logic [7:0]  rx_data_i,
  input  logic        rx_error_i,
  input  logic        rx_busy_i,
  // Transmitter
  output logic        tx_valid_o,
  output logic [7:0]  tx_data_o,
  input  logic        tx_ready_i,
  input  logic [31:0] word_i,
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

  localparam int Width = $clog2(QuietClocks);
  localparam logic [Width-1:0] Quiet = Width'(QuietClocks - 1);

  localparam logic [2:0] Command = 3'd0;
  localparam logic [2:0] Bytes   = 3'd1;  // of address and data
  localparam logic [2:0] Setup   = 3'd2;
  localparam logic [2:0] Access  = 3'd3;
  localparam logic [2:0] Answer  = 3'd4;
  localparam logic [2:0] Ignore  = 3'd5;  // the rest of a burst with an error

  localparam logic [7:0] NoRegister = 8'd1;
  localparam logic [7:0] NoCommand  = 8'd2;
  localparam logic [7:0] Framing    = 8'd3;
  localparam logic [7:0] Overrun    = 8'd4;

  logic [2:0]       state_q;
  logic             write_q, overrun_q;
  logic [2:0]       left_q;     // bytes of the command or the answer that are missing
  logic [47:0]      command_q;  // address and data; of a read, bits 15:0 are the address
  logic [39:0]      answer_q;   // its next byte is the upper one
  logic [7:0]       error_q;
  logic [Width-1:0] quiet_q;
  logic             event_seen, quiet, outside, overrun;
  logic [15:0]      address;

  // What the quiet time is counted from: a byte that is complete, or any that is under way
  assign event_seen = rx_valid_i | rx_error_i | rx_busy_i;
  assign quiet      = quiet_q == Quiet && !event_seen;
  assign address    = write_q ? command_q[47:32] : command_q[15:0];
  assign outside    = address[15:12] != '0;
  assign overrun    = overrun_q || rx_valid_i || rx_error_i;

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) quiet_q <= '0;
    else if (event_seen) quiet_q <= '0;
    else if (quiet_q != Quiet) quiet_q <= quiet_q + 1'b1;
  end

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      state_q   <= Command;
      write_q   <= 1'b0;
      overrun_q <= 1'b0;
      left_q    <= '0;
      command_q <= '0;
      answer_q  <= '0;
      error_q   <= '0;
    end else begin
      case (state_q)
        Command: begin
          overrun_q <= 1'b0;
          if (rx_error_i) begin
            error_q <= Framing;
            state_q <= Ignore;
          end else if (rx_valid_i) begin
            write_q <= rx_data_i == "W";
            case (rx_data_i)
              "R": begin
                left_q  <= 3'd2;
                state_q <= Bytes;
              end
              "W": begin
                left_q  <= 3'd6;
                state_q <= Bytes;
              end
              "S": begin
                answer_q <= {"s", word_i};
                left_q   <= 3'd5;
                state_q  <= Answer;
              end
              default: begin
                error_q <= NoCommand;
                state_q <= Ignore;
              end
            endcase
          end
        end
        Bytes: begin
          if (rx_error_i) begin
            error_q <= Framing;
            state_q <= Ignore;
          end else if (rx_valid_i) begin
            command_q <= {command_q[39:0], rx_data_i};
            left_q    <= left_q - 1'b1;
            if (left_q == 3'd1) state_q <= Setup;
          end else if (quiet) begin
            state_q <= Command;
          end
        end
        Setup: begin
          state_q <= Access;
          if (outside) begin
            answer_q <= {"e", NoRegister, 24'd0};
            left_q   <= 3'd2;
            state_q  <= Answer;
          end
        end
        Access: begin
          if (pready_i) begin
            answer_q <= write_q ? {"w", 32'd0} : {"r", prdata_i};
            left_q   <= write_q ? 3'd1 : 3'd5;
            state_q  <= Answer;
            if (pslverr_i) begin
              answer_q <= {"e", NoRegister, 24'd0};
              left_q   <= 3'd2;
            end
          end
        end
        Answer: begin
          if (tx_ready_i) begin
            answer_q <= {answer_q[31:0], 8'd0};
            left_q   <= left_q - 1'b1;
            if (left_q == '0) begin  // its last byte is over, too
              error_q <= Overrun;
              state_q <= overrun ? Ignore : Command;
            end
          end
        end
        default: begin
          if (quiet) begin
            answer_q  <= {"e", error_q, 24'd0};
            left_q    <= 3'd2;
            overrun_q <= 1'b0;
            state_q   <= Answer;
          end
        end
      endcase
      if (state_q == Setup || state_q == Access || state_q == Answer) overrun_q <= overrun;
    end
  end

  assign tx_valid_o = state_q == Answer && left_q != '0;
  assign tx_data_o  = answer_q[39:32];

  assign psel_o    = (state_q == Setup && !outside) || state_q == Access;
  assign penable_o = state_q == Access;
  assign pwrite_o  = write_q;
  assign paddr_o   = address[11:0];
  assign pwdata_o  = command_q[31:0];
  assign pstrb_o   = {4{write_q}};

endmodule
