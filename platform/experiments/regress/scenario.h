// The situations that a regression puts the coprocessor into.
#pragma once

#include <cstdint>
#include <vector>

#include "regress/bench.h"
#include "regress/corner_words.h"

namespace capsoc::regress {

/// How much of a random scenario to run.
struct Budget {
  uint64_t samples = 0, accesses = 0;
};

struct Scenario {
  const char* name;
  const char* purpose;
  /// Parts in a thousand of the regression's samples and accesses; a directed scenario has none and
  /// runs as often as there are seeds.
  unsigned sample_share, access_share;
  void (*run)(Bench&, Random&, const Budget&);

  bool directed() const { return sample_share == 0 && access_share == 0; }
};

/// All of them, in the order in which they are reported.
const std::vector<Scenario>& scenarios();

// scenarios_random.cpp
void run_stream(Bench& bench, Random& random, const Budget& budget);
void run_noise(Bench& bench, Random& random, const Budget& budget);
void run_traffic(Bench& bench, Random& random, const Budget& budget);
void run_interrupted(Bench& bench, Random& random, const Budget& budget);
void run_software(Bench& bench, Random& random, const Budget& budget);

// scenarios_arithmetic.cpp
void run_ties(Bench& bench, Random& random, const Budget&);
void run_saturation(Bench& bench, Random& random, const Budget&);
void run_quadrants(Bench& bench, Random& random, const Budget&);
void run_amplitudes(Bench& bench, Random& random, const Budget&);
void run_full_scale(Bench& bench, Random& random, const Budget&);
void run_beta(Bench& bench, Random& random, const Budget&);
void run_zero(Bench& bench, Random& random, const Budget&);
void run_step_ends(Bench& bench, Random& random, const Budget&);
void run_weight_clamp(Bench& bench, Random& random, const Budget&);
void run_loop_gains(Bench& bench, Random& random, const Budget&);
void run_thresholds(Bench& bench, Random& random, const Budget&);

// scenarios_timing.cpp
void run_spacing(Bench& bench, Random& random, const Budget&);
void run_load_moments(Bench& bench, Random& random, const Budget&);
void run_reset_moments(Bench& bench, Random& random, const Budget&);
void run_collisions(Bench& bench, Random& random, const Budget&);
void run_overruns(Bench& bench, Random& random, const Budget&);
void run_modes(Bench& bench, Random& random, const Budget&);

// scenarios_registers.cpp
void run_registers(Bench& bench, Random& random, const Budget&);
void run_pairs(Bench& bench, Random& random, const Budget&);
void run_flags(Bench& bench, Random& random, const Budget&);

// scenarios_bits.cpp
void run_threshold_bits(Bench& bench, Random& random, const Budget&);
void run_largest_error(Bench& bench, Random& random, const Budget&);
void run_stages(Bench& bench, Random& random, const Budget&);
void run_flag_bits(Bench& bench, Random& random, const Budget&);
void run_magnitudes(Bench& bench, Random& random, const Budget&);

// scenarios_enables.cpp
void run_enables(Bench& bench, Random& random, const Budget&);
void run_strobes(Bench& bench, Random& random, const Budget&);

// scenarios_golden.cpp
void run_golden(Bench& bench, Random& random, const Budget&);

// scenarios_judge.cpp
void run_turns(Bench& bench, Random& random, const Budget&);
void run_windings(Bench& bench, Random& random, const Budget&);
void run_windows(Bench& bench, Random& random, const Budget&);
void run_turn_count(Bench& bench, Random& random, const Budget&);
void run_limit_bits(Bench& bench, Random& random, const Budget&);
void run_turn_limit(Bench& bench, Random& random, const Budget&);
void run_passes(Bench& bench, Random& random, const Budget&);
void run_residue_limit(Bench& bench, Random& random, const Budget&);
void run_alarm(Bench& bench, Random& random, const Budget&);

// scenarios_block.cpp
void run_blocks(Bench& bench, Random& random, const Budget&);
void run_block_windows(Bench& bench, Random& random, const Budget&);
void run_block_sums(Bench& bench, Random& random, const Budget&);
void run_block_changes(Bench& bench, Random& random, const Budget&);

// scenarios_harmonics.cpp
void run_corrections(Bench& bench, Random& random, const Budget&);
void run_correction_nodes(Bench& bench, Random& random, const Budget&);
void run_correction_moments(Bench& bench, Random& random, const Budget&);

// scenarios_clamps.cpp
void run_lone_clamps(Bench& bench, Random& random, const Budget&);

// scenarios_settings.cpp
void run_settings(Bench& bench, Random& random, const Budget&);

// scenarios_safety.cpp
void run_parity(Bench& bench, Random& random, const Budget&);
void run_safety(Bench& bench, Random& random, const Budget&);

// scenarios_slew.cpp
void run_slew(Bench& bench, Random& random, const Budget&);

}  // namespace capsoc::regress
