// SPDX-License-Identifier: Apache-2.0
// Block learning (docs/reference/coprocessor.md): what becomes of T3's updates, and the sums of the block under way.
//
//   weight_i    s48, Q2.46: a coefficient as T3 leaves it, with weight_valid_i, one in each of the cycles 16, 18, 19, 22, 24
//               and 25, a_u to c_v
//   sum_o       s48, Q2.46: the block's sum of the one that will be at the ring's place 0 in the next cycle, from 13 on
//   learning_o  valid in T3's tick
//   bad_sum_o   from cycle 25 of it on: a sum that it read does not fit its parity bit
// With Present = 0 every update is a coefficient's. With Safety = 0 there are no parity bits.
module block_learning #(
  parameter int Present = 1,
  parameter int Safety  = 1,
  parameter int Channels = 1
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        clear_i,
  input  logic        boundary_i,
  input  logic [ 4:0] cycle_i,
  input  logic        active_i,    // T3 holds a sample
  // With boundary_i
  input  logic        start_i,     // T3 begins with a sample
  input  logic        learns_i,    // which learns
  input  logic        block_i,     // CTRL
  input  logic        guard_i,
  input  logic        bad_parity_i,  // the tick's sums get the wrong parity bits
  input  logic        commit_i,    // T4 ends with one
  input  logic        ended_i,     // which ended its window
  input  logic        good_i,      // the window that ended last, with that one, was good
  input  logic        timeout_i,   // ended by its time-out
  output learning_t   learning_o,
  input  logic        weight_valid_i,
  input  logic [47:0] weight_i,
  output logic [47:0] sum_o,
  output logic        bad_sum_o,
  input  logic        [ 3:0] channel_i,   // whose sums these are
  input  logic               shift_i,
  input  chain_t      chain_i,
  output chain_t      chain_o
);

  // open: the block began with a window; begun: a sample is in its sums; within: no window has ended
  // since T3's last sample began.
  logic open_q, begun_q, within_q;
  logic shift;
  logic [2:0] moved;
  assign shift = Channels > 1 && shift_i;
  context_chain #(.Channels(Channels), .Width(3)) u_chain (
    .kept_i({open_q, begun_q, within_q}), .chain_i, .moved_o(moved), .chain_o
  );
  logic block, ended, counts, sum, update;
  assign block = block_i && Present != 0;
  assign ended = commit_i ? ended_i : !within_q;
  assign counts = guard_i ? good_i : !timeout_i;
  assign sum = block && !ended && learns_i && open_q;
  assign update = learns_i && (!block || (ended && begun_q && counts));

  logic update_q, sum_q, from_sums_q, bad_parity_q;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      {open_q, begun_q, within_q} <= '0;
      {update_q, sum_q, from_sums_q, bad_parity_q} <= '0;
    end else if (clear_i) begin
      {open_q, begun_q, within_q} <= '0;
    end else if (boundary_i) begin
      update_q <= update;
      sum_q <= sum;
      from_sums_q <= block && begun_q;
      bad_parity_q <= bad_parity_i;
      if (start_i) begin
        open_q <= block && (open_q || ended);
        begun_q <= block && !ended && (begun_q || sum);
        within_q <= 1'b1;
      end else if (commit_i) begin
        within_q <= !ended_i;
      end
    end else if (shift) begin
      {open_q, begun_q, within_q} <= moved;
    end
  end
  assign learning_o.update = update_q;
  assign learning_o.sum = sum_q;
  assign learning_o.from_sums = from_sums_q;

  // When the ring takes a coefficient of T3, lms_demodulator.sv's cycle, and the place of its sum.
  typedef enum logic [4:0] {
    WriteAu = 5'd16,
    WriteBu = 5'd18,
    WriteCu = 5'd19,
    WriteAv = 5'd22,
    WriteBv = 5'd24,
    WriteCv = 5'd25
  } write_cycle_e;
  typedef enum logic [2:0] {
    SumAu = 3'd0,
    SumBu = 3'd1,
    SumCu = 3'd2,
    SumAv = 3'd3,
    SumBv = 3'd4,
    SumCv = 3'd5
  } sum_e;

  // The sums: six words of a channel, each below its parity bit. Synthesis takes a block memory for 64 words and more, and logic for
  // fewer.
  localparam int SumBits = Channels > 8 ? 7 : 6;
  logic [48:0] sums[0:2**SumBits-1];
  logic [SumBits-1:0] first_sum;
  logic unused_channel;  // of few
  assign first_sum = Channels > 1 ? SumBits'({channel_i, 3'd0}) : '0;
  assign unused_channel = ^channel_i;
  logic [48:0] sum_read_q;
  logic [2:0] write_address, read_address;
  always_comb begin
    unique case (cycle_i)
      WriteBu: write_address = SumBu;
      WriteCu: write_address = SumCu;
      WriteAv: write_address = SumAv;
      WriteBv: write_address = SumBv;
      WriteCv: write_address = SumCv;
      default: write_address = SumAu;
    endcase
    // A cycle before the ring takes it: it turns by one place a coefficient, three cycles before that is written.
    unique case (cycle_i)
      WriteAu - 5'd3, WriteAu - 5'd2, WriteAu - 5'd1: read_address = SumBu;
      WriteAu, WriteAu + 5'd1: read_address = SumCu;
      WriteBu: read_address = SumAv;
      WriteCu, WriteCu + 5'd1, WriteCu + 5'd2: read_address = SumBv;
      WriteAv, WriteAv + 5'd1: read_address = SumCv;
      default: read_address = SumAu;
    endcase
  end
  always_ff @(posedge clk_i) begin
    if (sum_q && weight_valid_i) sums[first_sum | SumBits'(write_address)] <= {Safety != 0 && (^weight_i ^ bad_parity_q), weight_i};
    if (active_i) sum_read_q <= sums[first_sum | SumBits'(read_address)];
  end
  assign sum_o = sum_read_q[47:0];

  // The ring takes a sum three cycles before the first is written, and with all but the last that are.
  logic taken, bad_sum_q;
  assign taken = cycle_i == WriteAu - 5'd3 || cycle_i == WriteAu || cycle_i == WriteBu || cycle_i == WriteCu ||
                 cycle_i == WriteAv || cycle_i == WriteBv;
  always_ff @(posedge clk_i) begin
    if (boundary_i) bad_sum_q <= 1'b0;
    else if (from_sums_q && taken) bad_sum_q <= Safety != 0 && (bad_sum_q || ^sum_read_q);
  end
  assign bad_sum_o = bad_sum_q;

`ifdef VERILATOR
  always_ff @(posedge clk_i) begin
    if (rst_ni && weight_valid_i)
      assert (cycle_i inside {WriteAu, WriteBu, WriteCu, WriteAv, WriteBv, WriteCv})
      else $error("a coefficient comes where the sums have no place for it");
  end
`endif

`ifdef FORMAL
  // A second reading port, so that a proof can relate one sum to its shadow.
  (* anyconst *) logic [2:0] probe;
  logic [48:0] probed;
  assign probed = sums[{3'b0, probe}];
`endif

endmodule
