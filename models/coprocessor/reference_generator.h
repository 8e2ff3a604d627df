// Reference generator: phase accumulator, reference multiplexer and rotation CORDIC.
#pragma once

#include "coprocessor/types.h"

namespace capsoc::coprocessor {

struct Rotation {
  int32_t sine = 0;    // Q1.31, full scale 2^31 - 1
  int32_t cosine = 0;  // Q1.31

  void visit(Archive& archive);
};

// Rotation CORDIC, 30 stages, 5 guard bits, rounded shifts. phase: u48, 2^-48 turn.
Rotation rotate(uint64_t phase);

// The paper's generator: 28 stages on 32-bit words, truncated shifts (section 3.3). phase: u48, of
// which the upper 32 bits are used.
Rotation rotate_paper(uint64_t phase);

// u48 phase to 2^-32 turn, half up (wraps).
uint32_t upper_phase(uint64_t phase);

// 2^-32 turn to u48.
constexpr uint64_t to_phase48(uint32_t angle) {
  return uint64_t{angle} << 16;
}

// Whether PHASE + FREQ passes 0, in either direction: the sample is the last one of its turn.
bool completes_turn(const ReferenceState& state);

constexpr uint64_t phase_mask = (uint64_t{1} << 48) - 1;

// The accumulator one sample on. residue: 2^-32 turn; steers only the tracking source:
// phase += residue / 2^kp, frequency += residue / 2^ki (both at 2^-48 turn, half up).
// A frequency beyond 48 bits saturates and sets `saturated`.
ReferenceState next_reference(const ReferenceState& state, ReferenceSource source, int32_t residue,
                              unsigned kp, unsigned ki, bool& saturated);

}  // namespace capsoc::coprocessor
