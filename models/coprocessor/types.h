// Plain values of the coprocessor's datapath. Formats: docs/reference/coprocessor.md.
#pragma once

#include <cstdint>

namespace capsoc {
class Archive;
}

namespace capsoc::coprocessor {

enum class Arithmetic { precise, paper };
enum class ReferenceSource : uint8_t { numeric = 0, tracking = 1, angle = 2 };

struct Options {
  Arithmetic arithmetic = Arithmetic::precise;
  int paper_operand_bits = 32;   // width of the PI arctangent's multipliers, 2..32 (Table 8: 16)
  int paper_reference_lead = 0;  // samples by which the reference leads the data (Table 8: 2)
  int paper_step_shift = 0;      // right shift of 2mu after the step registers, 0..31
  // The PI arctangent's input as the paper has it: neither shifted nor folded (Table 8: set).
  bool paper_plain_arctangent = false;
  // Clocks of an iteration of the PI arctangent, 1 or 2: a tick, and so the latency, is as many
  // times as long. The words are the same.
  int paper_iteration_clocks = 1;
  // CTRL.BLOCK exists; never in `paper`.
  bool block_learning = true;
  // CTRL.CORRECT and CORRECTION exist; never in `paper`.
  bool harmonic_correction = true;
  bool safety = true;  // SAFETY exists
  // Sensors that share the pipeline, 1..16. With more than one CHANNEL exists.
  int channels = 1;
};

// One channel's weights of Eq (7): sine, cosine and constant, Q2.46 in 48 bits.
// The paper's arithmetic holds Q1.31 in 32 bits; its words stand here times 2^15.
struct Weights {
  int64_t sine = 0;
  int64_t cosine = 0;
  int64_t constant = 0;

  void visit(Archive& archive);
};

struct Coefficients {
  Weights u;
  Weights v;

  void visit(Archive& archive);
};

// Block learning: the sums that become the coefficients when a window of the turn judge has ended.
struct BlockLearning {
  Coefficients sums;          // Q2.46; of no meaning before the block's first sample
  bool open = false;          // a block is under way: it began with a window
  bool begun = false;         // a sample is in its sums
  bool window_ended = false;  // since the last sample that T3 began with
  unsigned unfit = 0;         // a bit for each sum, a_u to c_v: it does not fit its parity bit

  static constexpr unsigned all_unfit = 0x3F;

  void visit(Archive& archive);
};

// Effective steps 2mu of one channel, unsigned Q1.31, below 2^31.
struct Steps {
  uint32_t sine = 0;
  uint32_t cosine = 0;
  uint32_t constant = 0;

  void visit(Archive& archive);
};

// The six parameters of Eq (5): amplitudes and offsets Q1.31, angles in 2^-32 turn.
struct Parameters {
  int32_t a1 = 0;
  int32_t a2 = 0;
  int32_t b1 = 0;
  int32_t b2 = 0;
  uint32_t beta = 0;
  uint32_t phi = 0;

  void visit(Archive& archive);
};

// The phase accumulator and its frequency word, 2^-48 turn (a sample).
struct ReferenceState {
  uint64_t phase = 0;     // u48, wraps: it is an angle
  int64_t frequency = 0;  // s48, the sign is the direction

  void visit(Archive& archive);
};

}  // namespace capsoc::coprocessor
