// The state of the coprocessor while nothing is in its pipeline, in one form for every device.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "coprocessor/datapath.h"
#include "coprocessor/device.h"
#include "coprocessor/harmonic_correction.h"
#include "coprocessor/sequencer.h"
#include "coprocessor/turn_judge.h"

namespace capsoc::coprocessor {

// Results that software sees; committed together at the end of T4.
struct Results {
  uint32_t raw_u = 0, raw_v = 0, cal_s = 0, cal_c = 0, angle = 0, error_u = 0, error_v = 0,
           residue = 0, reference_phase = 0, amplitude = 0, error_average = 0;
  bool lock = false, diverged = false, mirror = false, valid = false;

  void visit(Archive& archive);
};

// The architectural state: all that the future depends on when no sample and no LOAD is in the
// pipeline or waits for it. The model owns one of these, so that a member stands here and in
// visit(), and nowhere else. With several channels all but cycle, nodes and the last three members
// are of the active one.
struct IdleState {
  uint64_t cycle = 0;  // PCLK edge: the last one that has passed
  uint32_t ctrl = 0;
  uint32_t flags = 0;
  Settings settings;
  State state;
  Results results;
  JudgeSettings judge_settings;
  TurnJudge judge;
  uint32_t lock_threshold = 0;     // Q1.31
  uint32_t diverge_threshold = 0;  // Q1.31
  uint32_t soft_u = 0;
  uint32_t safety = 0;  // the register
  // Registers that do not fit their parity bit (register_map.h, parity_bit). The bits themselves
  // follow from it and from the registers.
  uint64_t unfit = 0;
  uint32_t samples = 0;
  uint32_t early_count = 0;
  unsigned settled = 0;  // samples since reset, up to 64: below that the averages mean nothing
  // Low words of the 48-bit registers: FREQ, PHASE, AU, BU, CU, AV, BV, CV.
  std::array<uint32_t, 8> staged_low{};
  std::array<uint32_t, 8> latched_low{};
  CorrectionTable corrections{};  // outlives a reset
  NodeBits unfit_corrections{};   // nodes that do not fit their parity bit; outlives it, too
  Nodes nodes;                    // of the last result
  // With several channels. A context for each, of which the active one's is empty.
  std::vector<IdleState> contexts;
  Selection selection;
  bool refused = false;  // CHANNEL.REFUSED

  void visit(Archive& archive);
};

}  // namespace capsoc::coprocessor
