// SPDX-License-Identifier: Apache-2.0
// Harmonic correction (docs/reference/coprocessor.md): what a table of 128 nodes over the sensor's angle, with straight lines between
// them, says that T1's relative angle is too large by.
//
//   phi_i         u32, 2^-32 turn: PHI, with boundary_i
//   relative_i    u32, 2^-32 turn: T1's, from cycle 11 on
//   value_i       s20, 2^-24 turn: becomes the node's at the edge of write_i, which comes while nothing is in the pipeline;
//                 with the wrong parity bit if bad_parity_i
//   relative_o    u32, 2^-32 turn: the corrected angle, in cycle 31 of T1 (from 30 on)
//   bad_node_o    then: a node of it does not fit its parity bit
//
// The fraction's bits, the lowest first, choose the node on the right (1) or on the left (0), whose value is added to half of
// the sum so far. Sixteen times that is exact: floor((T[j] (2^16 - f) + T[j + 1] f) / 2^16), if the sum begins with T[j].
//   12        the memory is asked for T[j]         13        sum = T[j]; asked for bit 0's
//   14 .. 29  sum = sum / 2 + word, and the last halving is a wire; in 14 sum + word
// With Present = 0 the angle passes as it is. With Safety = 0 there are no parity bits.
module harmonic_correction #(
  parameter int Present = 1,
  parameter int Safety  = 1,
  parameter int Channels = 1
) (
  input  logic        clk_i,
  input  logic        boundary_i,
  input  logic [ 4:0] cycle_i,
  input  logic        start_i,     // T1 begins with a sample, with boundary_i
  input  logic        correct_i,   // CTRL.CORRECT, with boundary_i
  input  logic [31:0] phi_i,
  input  logic        write_i,
  input  logic [ 6:0] node_i,
  input  logic [19:0] value_i,
  input  logic        bad_parity_i,
  input  logic [31:0] relative_i,
  output logic [31:0] relative_o,
  output logic        bad_node_o,
  input  logic [ 3:0] channel_i    // whose nodes these are
);

  // Registers as they were at the tick's start.
  logic correct_q;
  logic [31:9] phi_q;
  always_ff @(posedge clk_i) begin
    if (boundary_i) begin
      correct_q <= correct_i && start_i && Present != 0;
      phi_q <= phi_i[31:9];
    end
  end

  // Node and fraction; the bit that chooses a node is looked at a cycle before its value is there. Bit 0 stands at place 13,
  // bit 3 at place 0: the cycle is the number of the place.
  logic [22:0] position;
  logic [15:0] fraction;
  logic right;
  logic [6:0] address;
  assign position = relative_i[31:9] + phi_q;
  assign fraction = {position[2:0], position[15:3]};
  assign right = cycle_i != 5'd12 && fraction[cycle_i[3:0]];
  assign address = position[22:16] + 7'(right);

  // A parity bit and a node. Anything at power-up: software writes all nodes before it sets CORRECT.
  localparam int TableBits = 7 + $clog2(Channels);
  logic [20:0] table_memory[0:2**TableBits-1];
  logic [20:0] word_q;
  logic [TableBits-1:0] first_node;
  logic unused_channel;  // of few
  assign first_node = Channels > 1 ? TableBits'({channel_i, 7'd0}) : '0;
  assign unused_channel = ^channel_i;
  always_ff @(posedge clk_i) begin
    if (write_i) table_memory[first_node | TableBits'(node_i)] <= {Safety != 0 && (^value_i ^ bad_parity_i), value_i};
    if (|cycle_i[4:3]) word_q <= table_memory[first_node | TableBits'(address)];  // at rest nothing moves
  end

`ifdef VERILATOR
  always_ff @(posedge clk_i) begin
    assert (!write_i || boundary_i || cycle_i == '0) else $error("node %0d is written in cycle %0d of a tick", node_i, cycle_i);
  end
`endif

  logic signed [20:0] sum_q, halved;
  logic bad_node_q;
  assign halved = cycle_i[3:0] == 4'd14 ? sum_q : sum_q >>> 1;
  always_ff @(posedge clk_i) begin
    if (boundary_i || !correct_q) sum_q <= '0;
    else if (cycle_i >= 5'd13 && cycle_i <= 5'd29) sum_q <= halved + 21'($signed(word_q[19:0]));
  end
  always_ff @(posedge clk_i) begin
    if (boundary_i || !correct_q) bad_node_q <= 1'b0;
    else if (cycle_i > 5'd12 && cycle_i < 5'd30) bad_node_q <= Safety != 0 && (bad_node_q || ^word_q);
  end
  assign bad_node_o = bad_node_q;

  logic [23:0] correction;
  assign correction = 24'($signed(sum_q[20:1]));
  assign relative_o = {relative_i[31:8] - correction, relative_i[7:0]};

  logic unused_phi;
  assign unused_phi = ^phi_i[8:0];

`ifdef FORMAL
  // Two more reading ports, so that a proof can relate a node and its neighbour to their shadows.
  (* anyconst *) logic [6:0] probe;
  logic [6:0]  probe_right;
  logic [20:0] probed, probed_right;
  assign probe_right = probe + 7'd1;
  assign probed = table_memory[probe];
  assign probed_right = table_memory[probe_right];
`endif

endmodule
