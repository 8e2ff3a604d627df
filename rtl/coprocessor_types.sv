// SPDX-License-Identifier: Apache-2.0
// What goes together between the units of the coprocessor, as packed structs. Members are unsigned words;
// docs/reference/coprocessor.md has their formats. A register whose fields go to several units has the type that the register
// description makes for it, and its reserved bits are 0.
//
// The types belong to no package, and this file is read before the modules. Icarus Verilog 11 aborts at a port of a
// struct type with a package prefix (package::type), and yosys 0.23 does not read imports. Icarus assigns to a member
// of a member only in processes, so a unit fills the inner bundle and assigns it as a whole.
//
// A process reads a member of a wide bundle through its own wire. Verilator then traces every member to its source and
// removes the bundle. A bundle that a process or a path from outside accesses directly is packed into words in every
// cycle. For state_t that made a run 8.5 % slower.

// The six coefficients: s48, Q2.46
typedef struct packed {
  logic [47:0] au, bu, cu, av, bv, cv;
} weights_t;

// The six parameters: a1 .. b2 s32, Q1.31; beta and phi u32, 2^-32 turn
typedef struct packed {
  logic [31:0] a1, a2, b1, b2, beta, phi;
} parameters_t;

// The registers that software and the pipeline share; phase u48, freq s48, 2^-48 turn
typedef struct packed {
  logic [47:0] phase, freq;
  weights_t    weights;
  parameters_t parameters;
} state_t;

// Which of them the pipeline writes at a tick's boundary
typedef struct packed {
  logic phase, freq, weights_u, weights_v, parameters;
} state_we_t;

// Step of each coefficient: u31, Q1.31
typedef struct packed {
  logic [30:0] au, bu, cu, av, bv, cv;
} steps_t;

// The registers that software alone writes and the pipeline reads
typedef struct packed {
  logic        demod, calib;
  logic        block, guard;
  logic        correct;
  logic [1:0]  source;  // CTRL.REF
  logic [4:0]  kp, ki;
  capsoc_coprocessor_settings_t registers;  // by their names
  capsoc_coprocessor_safety_t safety;
} settings_t;

// What becomes of T3's updates: the coefficients, the sums of a block, or nothing
typedef struct packed {
  logic update, sum;
  logic from_sums;  // they are added to the sums, else to the coefficients
} learning_t;

// A write of CORRECTION: node 0 to 127; value s20, 2^-24 turn
typedef struct packed {
  logic        write;
  logic [6:0]  node;
  logic [19:0] value;
} correction_t;

// A change of context (channel_control.sv). A word of the chain through all flip-flops of a context (context_chain.sv), which are
// 32 words at the most
typedef struct packed {
  logic       shift;    // the chain moves at this edge, and the memories of words exchange word `index`
  logic       clear;    // with the last word: the new context begins as after a reset
  logic [4:0] index;
  logic [3:0] channel;  // whose context is in the registers; still the old one's in a change
} change_t;
typedef logic [40:0] chain_t;

// A word of a context: the chain's, and those of the memories for one channel
typedef struct packed {
  chain_t      chain;
  logic [31:0] words;    // register_bank.sv
  logic [31:0] sample;   // results_memory.sv
  logic [31:0] error;
  logic [31:0] quality;  // turn_judge.sv, results_memory.sv
} context_t;

// Interrupt enables, in CTRL's order
typedef struct packed {
  logic safety, alarm, turn, error, lock, result;
} enables_t;

// The running tick, and the edge that ends the interval if that is a tick's boundary. sequencer.sv says what a cycle is in a tick
// of 64 clocks.
typedef struct packed {
  logic       boundary;
  logic       enter;       // with boundary: a sample enters T0
  logic [5:0] clock;       // of the tick
  logic [4:0] cycle;       // of a unit's 32
  logic       rest;        // the cycle stays: only the paper's arctangents work
  logic [4:0] stage;       // bit s: stage Ts holds a sample
  logic [2:0] load;        // bit s: step Ls of a LOAD runs
  logic [2:0] load_start;  // with boundary: it begins
} tick_t;

// A sample as it comes: s32, Q1.31
typedef struct packed {
  logic [31:0] u, v;
  logic        clip;
} sample_t;

// What a commit sets in FLAGS in addition to RESULT
typedef struct packed {
  logic [3:0] safety;  // MISSED, JUMP, MISFIT, PARITY
  logic unsettled, alarm, turn, mirrorchg, diverged, lockchg, zero, sat, clip;
} flags_t;

// What the pipeline has to say in STATUS
typedef struct packed {
  logic [1:0] good_turns;
  logic       alarm, valid, mirror, diverged, lock;
} status_t;

// What an arithmetic (precise_core.sv, paper_core.sv) finds in addition to weights and parameters; words s32, Q1.31 unless said
typedef struct packed {
  logic        data_v;            // T3 wants v as its data in this cycle, else u
  logic        calibrated_valid;  // a calibrated word of T0, in this cycle
  logic        calibrated_s;      // it is S, else C
  logic [31:0] calibrated;
  logic        det_valid;         // det of T0, in this cycle
  logic [31:0] det;
  logic        amplitude_valid;   // T1's amplitude, in this cycle; T2's if late
  logic        amplitude_late;
  logic [31:0] amplitude;
  logic        error_valid;       // an error of T3, in this cycle
  logic        error_v;           // it is v's, else u's
  logic [31:0] error;
  logic        weight_valid;      // a coefficient as T3 leaves it, in this cycle
  logic [47:0] weight;            // s48, Q2.46
  logic [31:0] relative;          // of T1, not corrected, in cycle 31 (precise: from 11 on); 2^-32 turn
  logic [31:0] angle;             // of T4, in cycle 31; 2^-32 turn
  logic        zero, mirror;      // of T1, of T0, in cycle 31
  logic        unsettled1;        // in cycle 31: the arctangent of T1, of T4 has not converged
  logic        unsettled4;
  logic [4:0]  saturated;         // bit s: Ts loses high bits in this cycle
} core_t;
