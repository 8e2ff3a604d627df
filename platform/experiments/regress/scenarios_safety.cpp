// Safety mechanisms: parity bits of every register, errors and steps at and next to each limit,
// results that are not taken, and the settings at every edge of a sample's way.
#include <array>
#include <cmath>

#include "coprocessor/harmonic_correction.h"
#include "coprocessor/register_map.h"
#include "regress/scenario.h"

namespace capsoc::regress {

using namespace coprocessor;

namespace {

constexpr uint32_t calibrating = ctrl_adc | ctrl_calib;
constexpr uint32_t all_on = safety_parity | safety_misfit | safety_jump | safety_missed;

uint32_t limits(unsigned error, unsigned step) {
  return error << safety_error_limit_shift | step << safety_step_limit_shift;
}

void begin(Bench& bench, uint32_t ctrl, uint32_t safety) {
  bench.drain();
  bench.wait(2);
  bench.write(reg_ctrl, ctrl_srst);
  bench.write(reg_ctrl, ctrl);  // with the right parity bit
  bench.write(reg_safety, safety);
}

// Takes the result, with what can be seen of it.
void take(Bench& bench) {
  bench.drain();
  bench.read(reg_flags);
  bench.read(reg_status);
  bench.read(reg_angle);
  bench.interrupt();
  bench.write(reg_flags, flags_all);
}

// SAFETY as wanted, with the right parity bit: BAD_PARITY is 0 when the second write comes.
void set_safety(Bench& bench, uint32_t safety) {
  bench.write(reg_safety, safety & ~safety_bad_parity);
  bench.write(reg_safety, safety);
}

// A word that every register takes, and that changes no more than it has to.
uint32_t harmless(uint32_t offset, uint32_t ctrl, uint32_t safety, Random& random) {
  switch (offset) {
    case reg_ctrl:
      return ctrl;
    case reg_safety:
      return safety;
    case reg_judge:
      return random.word32();
    default:
      return random.word32() >> 4;
  }
}

void write_word(Bench& bench, uint32_t offset, uint32_t value) {
  if (is_pair(offset)) bench.write(offset, value >> 16);
  bench.write(is_pair(offset) ? offset + 4 : offset, value);
}

// Every register alone gets a wrong bit; the sample after it shows that, and the one after the
// right bit is back does not.
void each_parity(Bench& bench, Random& random, uint32_t ctrl) {
  for (const uint32_t offset : parity_registers) {
    if (bench.failed()) return;
    begin(bench, ctrl, safety_parity | safety_bad_parity);
    // SAFETY's own bit is wrong already if it is written with BAD_PARITY before.
    const uint32_t safety =
        offset == reg_safety ? safety_parity | safety_bad_parity : safety_parity;
    write_word(bench, offset, harmless(offset, ctrl, safety, random));
    if (offset != reg_safety) set_safety(bench, safety);
    for (unsigned i = 0; i < 2; ++i) {
      bench.sample(random.word32(), random.word32());
      take(bench);
    }
    set_safety(bench, safety_parity);
    write_word(bench, offset, harmless(offset, ctrl, safety_parity, random));
    bench.sample(random.word32(), random.word32());
    take(bench);
  }
}

// Every register takes several words, some with a wrong bit, and the sample after each tells which.
void parity_of_words(Bench& bench, Random& random, uint32_t ctrl) {
  for (const uint32_t offset : parity_registers) {
    if (offset == reg_ctrl || offset == reg_safety) continue;  // their words decide what is seen
    begin(bench, ctrl, safety_parity);
    for (unsigned i = 0; i < 8 && !bench.failed(); ++i) {
      set_safety(bench, safety_parity | (random.chance(0.5) ? safety_bad_parity : 0));
      write_word(bench, offset, random.word32() >> random.below(2));  // some registers refuse 2^31
      set_safety(bench, safety_parity);
      bench.sample(random.word32(), random.word32());
      take(bench);
    }
  }
}

constexpr double radius = 2147000000, whole_turn = 6.283185307179586;

// With the reset's coefficients the sensor's angle, in turns.
void sample_at(Bench& bench, double angle) {
  const auto word = [](double value) { return static_cast<uint32_t>(static_cast<int32_t>(value)); };
  bench.sample(word(radius * std::sin(whole_turn * angle)),
               word(radius * std::cos(whole_turn * angle)));
}

// A node with the wrong bit, and samples in front of its neighbours, at it, and after it.
void parity_of_nodes(Bench& bench, Random& random) {
  const auto write_node = [&](unsigned node) {
    bench.write(reg_correction, node << description::CORRECTION_NODE_shift |
                                    (random.word32() & correction_value_mask));
  };
  begin(bench, 0, safety_parity);
  for (unsigned node = 0; node < correction_nodes; ++node) write_node(node);
  bench.write(reg_ctrl, calibrating | ctrl_correct);
  for (unsigned i = 0; i < 32 && !bench.failed(); ++i) {
    // Every second one is at a quarter of a turn, whose angle has no fraction.
    const unsigned node = i % 2 == 0 ? i / 2 % 4 * 32 : random.below(correction_nodes);
    set_safety(bench, safety_parity | safety_bad_parity);
    write_node(node);
    set_safety(bench, safety_parity);
    for (const double beside : {-1.5, -1.0, -0.5, 0.0, 0.5, 1.0}) {
      sample_at(bench, (node + beside) / correction_nodes);
      take(bench);
    }
    write_node(node);
    sample_at(bench, (node + 0.5) / correction_nodes);
    take(bench);
  }
}

// Sums that a tick has written with the wrong bits, as the next sample of the block reads them.
void parity_of_sums(Bench& bench, Random& random) {
  begin(bench, calibrating | ctrl_demod | ctrl_block, safety_parity);
  bench.write(reg_judge, description::JUDGE_reset | judge_count);
  bench.write(reg_turn_limit, 5);
  for (unsigned i = 0; i < 64 && !bench.failed(); ++i) {
    set_safety(bench, safety_parity | (random.chance(0.4) ? safety_bad_parity : 0));
    bench.sample(random.word32() >> 2, random.word32() >> 2);
    if (random.chance(0.5)) {
      bench.wait(random.below(static_cast<unsigned>(bench.latency())));
      set_safety(bench, safety_parity | (random.chance(0.5) ? safety_bad_parity : 0));
    }
    take(bench);
  }
}

// A wrong bit that no enabled mechanism looks at.
void unwatched_parity(Bench& bench, Random& random) {
  for (const uint32_t offset : {reg_loop, reg_bv_lo}) {
    if (bench.failed()) return;
    begin(bench, calibrating, safety_bad_parity);
    write_word(bench, offset, random.word32() >> 4);
    set_safety(bench, 0);
    bench.sample(random.word32(), random.word32());
    take(bench);
  }
}

// A wrong bit that comes, or goes, at each edge of the way of two samples; by the bus or as the
// pipeline writes the register.
void parity_at_every_edge(Bench& bench, Random& random, uint32_t ctrl) {
  constexpr std::array<uint32_t, 6> some = {reg_phase_lo, reg_freq_lo, reg_au_lo,
                                            reg_bv_lo,    reg_a1,      reg_turn_limit};
  for (unsigned edge = 0; edge < bench.scaled(200) && !bench.failed(); ++edge) {
    const uint32_t offset = some[edge % some.size()];
    const bool comes = random.chance(0.5);
    begin(bench, ctrl, safety_parity | safety_bad_parity);
    if (!comes) {
      write_word(bench, offset, random.word32() >> 4);
      set_safety(bench, safety_parity);
    }
    const uint64_t start = bench.edge();
    bench.sample(random.word32() >> 2, random.word32() >> 2);
    bench.wait(bench.tick());
    bench.sample(random.word32() >> 2, random.word32() >> 2);
    bench.wait_until(start + edge);
    if (random.chance(0.2))
      bench.write(reg_cmd, cmd_phase0 | (random.chance(0.5) ? cmd_load : 0));
    else
      write_word(bench, offset, random.word32() >> 4);
    take(bench);
    bench.sample(random.word32(), random.word32());
    take(bench);
  }
}

// The error of a sample is its data: no coefficients.
void around_error_limits(Bench& bench, Random& random) {
  begin(bench, calibrating, safety_misfit);
  for (uint32_t pair = reg_au_lo; pair < reg_cv_hi; pair += 8) bench.write_pair(pair, 0);
  for (unsigned n = 0; n < 32; ++n) {
    bench.write(reg_safety, safety_misfit | limits(n, 0));
    const uint32_t limit = n == 0 ? 0x80000000u : 1u << (31 - n);
    for (const uint32_t word : {limit - 1, limit, 0u - limit, ~limit}) {
      for (unsigned channel = 0; channel < 2; ++channel) {
        if (bench.failed()) return;
        bench.sample(channel == 0 ? word : 0, channel == 0 ? 0 : word);
        take(bench);
      }
    }
    // One bit beyond the limit alone decides.
    const uint32_t bit = 1u << random.below(31);
    bench.sample(bit, ~bit);
    take(bench);
  }
}

// Angles that differ by about half a turn / 2^n, more and less.
void around_step_limits(Bench& bench, Random& random) {
  for (unsigned n = 0; n < 32; ++n) {
    if (bench.failed()) return;
    begin(bench, calibrating, safety_jump | limits(0, n));
    // The reset's coefficients: angles of the samples themselves, here in turns.
    const double limit = std::ldexp(1.0, -1 - static_cast<int>(n >= 29 ? 29 : n));
    double angle = random.uniform();
    for (unsigned i = 0; i < 24; ++i) {
      const double beside = std::ldexp(random.uniform() - 0.5, -28);
      angle += i % 3 == 0   ? limit + beside
               : i % 3 == 1 ? -limit + beside
                            : limit * 2 * (random.uniform() - 0.5);
      sample_at(bench, angle);
      take(bench);
    }
  }
}

// A result that is taken, or not, at each edge around the next commit; and mechanisms that are
// switched at each edge of a sample's way.
void settings_at_every_edge(Bench& bench, Random& random) {
  for (unsigned edge = 0; edge < bench.scaled(200) && !bench.failed(); ++edge) {
    begin(bench, calibrating | ctrl_ie_safety, all_on | limits(31, 29));
    bench.sample(random.word32(), random.word32());
    bench.drain();
    const uint64_t start = bench.edge();
    bench.sample(random.word32(), random.word32());
    bench.wait_until(start + edge);
    switch (edge % 3) {
      case 0:
        bench.write(reg_flags, flags_all);
        break;
      case 1:
        bench.write(reg_safety, random.word32());
        break;
      default:
        bench.write(reg_flags, 1u << (flags_safety_shift + random.below(4)));
    }
    bench.interrupt();
    bench.drain();
    bench.read(reg_status);
    bench.read(reg_safety);
    bench.read(reg_flags);
  }
  // Around the second commit, where the order of the two counts.
  for (unsigned beside = 0; beside < 8 && !bench.failed(); ++beside) {
    begin(bench, calibrating, safety_missed);
    bench.sample(random.word32(), random.word32());
    bench.drain();
    const uint64_t start = bench.edge();
    bench.sample(random.word32(), random.word32());
    bench.wait_until(start + bench.latency() - 4 + beside);
    bench.write(reg_flags, flag_result);
    take(bench);
  }
}

// Each flag, set since before, takes VALID from the next sample and keeps ANGLE.
void distrust(Bench& bench, Random& random) {
  for (unsigned bit = 0; bit < 4 && !bench.failed(); ++bit) {
    begin(bench, calibrating, all_on | safety_bad_parity | limits(31, 29));
    bench.write(reg_safety, all_on | safety_bad_parity | limits(31, 29));
    for (unsigned i = 0; i < 2; ++i) bench.sample(random.word32(), random.word32()), bench.drain();
    set_safety(bench, 0);
    bench.write(reg_flags, flags_all & ~(1u << (flags_safety_shift + bit)));
    for (unsigned i = 0; i < 2; ++i) {
      bench.sample(random.word32(), random.word32());
      bench.drain();
      bench.read(reg_status);
      bench.read(reg_angle);
      bench.interrupt();
    }
    bench.write(reg_flags, flags_all);
    bench.sample(random.word32(), random.word32());
    take(bench);
  }
}

}  // namespace

void run_parity(Bench& bench, Random& random, const Budget&) {
  each_parity(bench, random, calibrating);
  each_parity(bench, random, calibrating | ctrl_demod | 1u << ctrl_ref_shift | ctrl_ie_safety);
  parity_of_words(bench, random, calibrating);
  parity_of_nodes(bench, random);
  parity_of_sums(bench, random);
  unwatched_parity(bench, random);
  parity_at_every_edge(bench, random, calibrating);
  parity_at_every_edge(bench, random, calibrating | ctrl_demod | 1u << ctrl_ref_shift);
  bench.drain();
}

void run_safety(Bench& bench, Random& random, const Budget&) {
  around_error_limits(bench, random);
  around_step_limits(bench, random);
  settings_at_every_edge(bench, random);
  distrust(bench, random);
  bench.drain();
}

}  // namespace capsoc::regress
