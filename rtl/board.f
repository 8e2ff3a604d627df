// SPDX-License-Identifier: Apache-2.0
// What puts the design of coprocessor.f on an FPGA board, read after it: serial port, ADC, and a top for each board.
board/capsoc_serial_receiver.sv
board/capsoc_serial_transmitter.sv
board/capsoc_serial_to_apb.sv
board/capsoc_status_reader.sv
board/capsoc_adc_max11125.sv
board/capsoc_board_ulx3s.sv
