// SPDX-License-Identifier: Apache-2.0
// Keeps the results of a sample from all stages until software reads them. Each word is written once, in the cycle in
// which it is computed, under the sample's slot number.
//
// All words are s32 or u32 and pass through unchanged. Eight slots: five samples in flight, the
// committed one, and a power of two. Reads are combinational. There are three memories, so that no two writes collide.
// One has the sample and calibrated words of T0. One has the residue and reference phase of T2 (cycles 0, 1) and the
// errors of T3 (later cycles). One has the words of turn_judge.sv, which lists their addresses.
module results_memory #(
  parameter int Channels = 1
) (
  input  logic        clk_i,
  input  logic        sample_we_i,
  input  logic [ 1:0] sample_word_i,   // 0 u, 1 v, 2 S, 3 C
  input  logic [31:0] sample_i,
  input  logic [ 2:0] sample_slot_i,
  input  logic        error_we_i,
  input  logic [ 1:0] error_word_i,    // 0 reference phase, 1 error u, 2 error v, 3 residue
  input  logic [31:0] error_i,
  input  logic [ 2:0] error_slot_i,
  input  logic        quality_we_i,
  input  logic [ 4:0] quality_address_i,
  input  logic [31:0] quality_i,
  input  logic        bank_i,          // of the last window's record
  input  logic        data_read_i,     // T3 holds a sample, which it reads
  input  logic        data_v_i,
  input  logic [ 2:0] data_slot_i,
  output logic [31:0] data_o,          // a cycle later
  // 0..3 sample, 5..8 error (8: word 0), 9 amplitude, 10 average, 11..14 radius, residue, winding,
  // samples, 15 DET of the record
  input  logic [ 3:0] select_i,
  input  logic [ 2:0] slot_i,
  output logic [31:0] result_o,
  // In a change: word index_i of the old channel, of the new one; turn_judge.sv writes `quality`.
  input  logic               shift_i,
  input  logic        [ 4:0] index_i,
  input  logic [31:0] context_sample_i,
  input  logic [31:0] context_error_i,
  output logic [31:0] context_sample_o,
  output logic [31:0] context_error_o,
  output logic [31:0] context_quality_o
);

  logic [31:0] sample[0:31];
  // u and v again, 16 words: a memory of this kind has one read port. Synthesis takes a block memory for
  // 64 words and more, and logic for fewer.
  logic [31:0] data[0:63];
  logic [31:0] data_q;
  logic [31:0] error[0:31];
  logic [31:0] quality[0:31];

  // No reset: a word is read only after its sample has passed.
  logic shift;
  logic [4:0] sample_address, error_address;
  logic [31:0] sample_written, error_written;
  assign shift = Channels > 1 && shift_i;
  assign sample_address = shift ? index_i : {sample_slot_i, sample_word_i};
  assign sample_written = shift ? context_sample_i : sample_i;
  always_ff @(posedge clk_i) begin
    if (sample_we_i || shift) sample[sample_address] <= sample_written;
  end
  always_ff @(posedge clk_i) begin
    if (sample_we_i && !sample_word_i[1]) data[{2'b0, sample_slot_i, sample_word_i[0]}] <= sample_i;
    if (data_read_i) data_q <= data[{2'b0, data_slot_i, data_v_i}];
  end
  always_ff @(posedge clk_i) begin
    if (error_we_i || shift) error[error_address] <= error_written;
  end
  assign error_address = shift ? index_i : {error_slot_i, error_word_i};
  assign error_written = shift ? context_error_i : error_i;
  always_ff @(posedge clk_i) begin
    if (quality_we_i) quality[quality_address_i] <= quality_i;
  end

  assign data_o = data_q;

  logic [31:0] sample_read, error_read, quality_read;
  logic [4:0] read_address;
  assign read_address = shift ? index_i : {slot_i, select_i[1:0]};
  assign sample_read = sample[read_address];
  assign error_read = error[read_address];
  logic [4:0] quality_read_address;
  always_comb begin
    if (shift) quality_read_address = index_i;
    else case (select_i[2:0])
      3'd1: quality_read_address = {2'b00, slot_i};
      3'd2: quality_read_address = {3'b010, slot_i[1:0]};
      3'd7: quality_read_address = {4'b1011, bank_i};
      default: quality_read_address = {2'b11, bank_i, select_i[1:0] + 2'd1};
    endcase
  end
  assign quality_read = quality[quality_read_address];
  assign context_sample_o = sample_read;
  assign context_error_o = error_read;
  assign context_quality_o = quality_read;
  assign result_o = select_i[3:2] == 2'd0 ? sample_read :
                    select_i[3] && select_i[2:0] != 3'd0 ? quality_read : error_read;

endmodule
