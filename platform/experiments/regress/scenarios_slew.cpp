// Limited slew: errors at each limit and next to it, and the setting at every edge.
#include <array>

#include "coprocessor/register_map.h"
#include "regress/scenario.h"

namespace capsoc::regress {

using namespace coprocessor;

namespace {

constexpr uint32_t slewing = ctrl_adc | ctrl_demod | ctrl_calib;

// The error of a sample will be its data: no coefficients.
void no_coefficients(Bench& bench) {
  bench.drain();
  for (uint32_t pair = reg_au_lo; pair < reg_cv_hi; pair += 8) bench.write_pair(pair, 0);
}

void begin_slewing(Bench& bench, Random& random, uint32_t ctrl, unsigned slew) {
  bench.drain();
  bench.wait(2);
  bench.write(reg_ctrl, ctrl_srst);
  bench.write(reg_judge, 0x3333 | slew << judge_slew_shift);
  for (uint32_t offset = reg_step_au; offset <= reg_step_cv; offset += 4)
    bench.write(offset, 0x40000000u | random.word32() >> 2);
  bench.write_pair(reg_freq_lo, int64_t{0x123456789ABC});
  bench.write(reg_ctrl, ctrl);
}

void learn_from(Bench& bench, uint32_t u, uint32_t v) {
  no_coefficients(bench);
  bench.sample(u, v);
  bench.drain();
  for (uint32_t high = reg_au_lo + 4; high <= reg_cv_hi; high += 8) bench.read(high);
  bench.read(reg_err_u);
  bench.read(reg_flags);
  bench.write(reg_flags, flags_all);
}

// Errors around the limit, of either sign, in each channel and in both.
void around_limits(Bench& bench, Random& random, uint32_t ctrl) {
  for (unsigned n = 0; n < 8; ++n) {
    if (bench.failed()) return;
    begin_slewing(bench, random, ctrl, n);
    const uint32_t limit = 1u << (31 - 2 * n);
    for (uint32_t beside : {~1u, ~0u, 0u, 1u})
      for (uint32_t word : {limit + beside, 0u - limit + beside}) {
        const uint32_t small = random.word32() >> 20;
        learn_from(bench, word, small);
        learn_from(bench, 0u - small, word);
        learn_from(bench, word, ~word);
      }
    for (uint32_t word : {0x7FFFFFFFu, 0x80000000u, 0u, ~0u})
      learn_from(bench, word, random.chance(0.5) ? word : ~word);
  }
}

// One bit beyond the sign alone decides.
void single_bits(Bench& bench, Random& random) {
  for (unsigned n = 0; n < 8; ++n) {
    if (bench.failed()) return;
    begin_slewing(bench, random, slewing, n);
    for (unsigned bit = 14; bit < 31; ++bit) {
      const uint32_t word = 1u << bit | random.word32() >> 19;
      learn_from(bench, word, ~word);
      learn_from(bench, ~word, word);
    }
  }
}

// The setting at every edge of the way of samples that are beyond some of its limits.
void setting_at_every_edge(Bench& bench, Random& random) {
  begin_slewing(bench, random, slewing, 0);
  for (unsigned edge = 0; edge < bench.scaled(200) && !bench.failed(); ++edge) {
    bench.drain();
    const uint64_t start = bench.edge();
    bench.sample(random.word32() & 0x3FFFFFFF, random.word32() | 0xC0000000);
    bench.wait(bench.tick());
    bench.sample(random.word32() >> 6, 0u - (random.word32() >> 12));
    bench.wait_until(start + edge);
    bench.write(reg_judge, 0x3333 | static_cast<uint32_t>(edge % 8) << judge_slew_shift);
    bench.drain();
    bench.read(reg_flags);
    bench.write(reg_flags, flags_all);
  }
}

}  // namespace

void run_slew(Bench& bench, Random& random, const Budget&) {
  around_limits(bench, random, slewing);
  around_limits(bench, random, ctrl_adc | ctrl_calib);
  single_bits(bench, random);
  setting_at_every_edge(bench, random);
  // A limit that is met by samples back to back, whose errors differ.
  for (unsigned n = 1; n < 8; ++n) {
    begin_slewing(bench, random, slewing, n);
    for (unsigned i = 0; i < 24 && !bench.failed(); ++i) {
      bench.sample(corner32(random), random.word32() >> random.below(32));
      bench.wait(bench.tick());
    }
  }
  bench.drain();
}

}  // namespace capsoc::regress
