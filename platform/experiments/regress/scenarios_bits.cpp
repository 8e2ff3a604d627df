// Directed sequences in which one bit, or one word of many, decides.
#include <array>
#include <utility>
#include <vector>

#include "coprocessor/register_map.h"
#include "regress/scenario.h"

namespace capsoc::regress {

using namespace coprocessor;

namespace {

constexpr uint32_t both = ctrl_adc | ctrl_demod | ctrl_calib;
constexpr int64_t one = int64_t{1} << 46;  // Q2.46

void fresh(Bench& bench, uint32_t ctrl) {
  bench.drain();
  bench.wait(2);
  bench.write(reg_ctrl, ctrl_srst);
  bench.write(reg_ctrl, ctrl);
}

// No coefficients and no steps: the error is the data.
void pass_through(Bench& bench) {
  fresh(bench, both | ctrl_ie_lock);
  bench.write(reg_judge, 0);  // LOCK by the average alone
  for (uint32_t offset = reg_step_au; offset <= reg_step_cv; offset += 4) bench.write(offset, 0);
  for (uint32_t pair = reg_au_lo; pair < reg_cv_hi; pair += 8) bench.write_pair(pair, 0);
}

std::vector<uint32_t> pairs() {
  std::vector<uint32_t> lows = {reg_freq_lo, reg_phase_lo};
  for (uint32_t offset = reg_au_lo; offset < reg_cv_hi; offset += 8) lows.push_back(offset);
  return lows;
}

// The LO words first: they show a latch that should not be there.
void read_words(Bench& bench, const std::vector<uint32_t>& lows) {
  for (uint32_t low : lows) bench.read(low);
  for (uint32_t offset = reg_step_au; offset <= reg_step_cv; offset += 4) bench.read(offset);
  for (uint32_t offset : {reg_lock_threshold, reg_diverge_threshold, reg_soft_u, reg_soft_v})
    bench.read(offset);
}

void write_highs(Bench& bench, Random& random, const std::vector<uint32_t>& lows) {
  for (uint32_t low : lows) {
    bench.write(low + 4, random.word32());
    bench.read(low + 4);
    bench.read(low);
  }
}

}  // namespace

void run_threshold_bits(Bench& bench, Random& random, const Budget&) {
  // Thresholds that differ from the average in one bit: it alone decides. The larger average is
  // u's, then v's.
  for (bool swapped : {false, true}) {
    pass_through(bench);
    for (unsigned i = 0; i < 70; ++i) {
      const uint32_t large = random.word32() >> 1, small = large >> 3;
      bench.sample(swapped ? small : large, swapped ? large : small);
      bench.wait(bench.tick());
    }
    bench.drain();
    for (unsigned i = 0; i < 64 && !bench.failed(); ++i) {
      // An error of the average's size leaves it as it is.
      const auto average = static_cast<uint32_t>(bench.nodes().error_average);
      bench.write(reg_lock_threshold, average ^ (1u << (i % 32)));
      bench.write(reg_diverge_threshold, average ^ (1u << (i * 7 % 32)));
      bench.sample(swapped ? 0 : average, swapped ? average : 0);
      bench.drain();
      bench.read(reg_status);
      bench.write(reg_flags, flags_all);
    }
  }
  // Averages of u and v that differ from one bit on.
  for (unsigned bit = 0; bit < 31 && !bench.failed(); ++bit) {
    pass_through(bench);
    const uint32_t u = random.word32() >> 1, v = u ^ (1u << bit);
    for (unsigned i = 0; i < 3; ++i) {
      bench.sample(u, 0u - v);
      bench.wait(bench.tick());
    }
    bench.drain();
  }
}

void run_largest_error(Bench& bench, Random&, const Budget&) {
  // An error of -1 again and again: each sum comes to rest at 2^37 - 32, the average at 2^31. In u,
  // then in v.
  for (bool swapped : {false, true}) {
    pass_through(bench);
    const int64_t largest = one - (int64_t{1} << 15);            // the largest word of Q1.31
    bench.write_pair(reg_au_lo + (swapped ? 40 : 16), largest);  // CV, CU
    for (unsigned i = 0; i < 1800 && !bench.failed(); ++i) {
      bench.sample(swapped ? 0 : 0x80000000, swapped ? 0x80000000 : 0);
      bench.wait(bench.tick());
    }
    for (uint32_t threshold : {0x7fffffffu, 0x80000000u, 0x80000001u}) {
      bench.write(reg_lock_threshold, threshold);
      bench.write(reg_diverge_threshold, threshold);
      bench.sample(swapped ? 0 : 0x80000000, swapped ? 0x80000000 : 0);
      bench.drain();
      bench.read(reg_error_average);
      bench.read(reg_status);
      bench.write(reg_flags, flags_all);
    }
  }
}

void run_stages(Bench& bench, Random& random, const Budget&) {
  const std::vector<uint32_t> lows = pairs();
  // One word of the memory written after a reset, or read as HI: no other has become valid.
  for (uint32_t offset = reg_freq_lo; offset <= reg_soft_u && !bench.failed(); offset += 4)
    for (bool write : {true, false}) {
      if (offset == reg_status || offset == reg_ctrl) continue;
      for (bool highs : {false, true}) {
        fresh(bench, 0);
        if (write)
          bench.write(offset, random.word32() >> 1);
        else
          bench.read(offset);
        if (highs) write_highs(bench, random, lows);
        read_words(bench, lows);
        if (!highs) bench.soft_sample(random.word32(), random.word32());
        if (!highs) bench.drain();
      }
    }
  // All of them written: a HI takes the stage of its own LO only.
  for (uint32_t taken : lows) {
    if (bench.failed()) return;
    fresh(bench, 0);
    for (uint32_t offset = reg_step_au; offset <= reg_step_cv; offset += 4)
      bench.write(offset, random.word32() >> 1);
    bench.write(reg_lock_threshold, random.word32());
    bench.write(reg_diverge_threshold, random.word32());
    bench.write(reg_soft_u, random.word32());
    for (uint32_t low : lows) bench.write(low, random.word32());
    bench.write(taken + 4, random.word32());
    bench.read(taken + 4);
    write_highs(bench, random, lows);
    read_words(bench, lows);
  }
}

void run_flag_bits(Bench& bench, Random& random, const Budget&) {
  for (uint32_t bit = 0; bit < flag_count; ++bit)
    for (uint32_t enabled :
         {ctrl_ie_result, ctrl_ie_lock, ctrl_ie_error, ctrl_ie_turn, ctrl_ie_alarm}) {
      if (bench.failed()) return;
      fresh(bench, both | enabled);
      // All flags: an orientation, a saturated and clipped sample, a lost one, an empty one, a
      // refused write.
      bench.write(reg_beta, 1u << 31);
      bench.write_pair(reg_au_lo, -one / 2);
      bench.write(reg_a1, 1u << 31);
      bench.sample(0x80000000u, 0x80000000u, true);
      bench.wait(bench.scaled(40));
      for (unsigned i = 0; i < 3; ++i) bench.sample(random.word32(), random.word32());
      bench.wait(bench.scaled(90));
      for (uint32_t pair = reg_au_lo; pair < reg_cv_hi; pair += 8) bench.write_pair(pair, 0);
      bench.write(reg_a1, 0);
      bench.write(reg_a2, 0);
      bench.drain();
      bench.sample(0, 0);
      bench.drain();
      // One goes, the others stay.
      bench.interrupt();
      bench.write(reg_flags, 1u << bit);
      bench.interrupt();
      bench.read(reg_flags);
      bench.write(reg_flags, flags_all & ~(1u << bit));
      bench.interrupt();
      bench.read(reg_flags);
      bench.write(reg_flags, flags_all);
      bench.interrupt();
    }
}

void run_magnitudes(Bench& bench, Random& random, const Budget&) {
  pass_through(bench);
  // Vectors (x, y), Q2.46, whose magnitude is so near to one half of a unit that an error of one
  // in the last place of the polar unit's gain rounds it the other way.
  constexpr std::array<std::pair<int64_t, int64_t>, 6> vectors = {
      {{-13236006837524, -13180994802493},
       {-28525451015262, 4698484575186},
       {-1312909605645, 15507329489672},
       {33611823667284, -20630268129750},
       {23779585415368, -4343949646737},
       {2709649139854, 7935660705513}}};
  for (const auto& [x, y] : vectors) {
    if (bench.failed()) return;
    bench.drain();
    bench.write_pair(reg_au_lo, x);
    bench.write_pair(reg_au_lo + 8, y);
    bench.write_pair(reg_au_lo + 24, -y);
    bench.write_pair(reg_au_lo + 32, x);
    bench.sample(random.word32(), random.word32());
    bench.drain();
    bench.read(reg_a1);
    bench.read(reg_a2);
  }
  // Offsets at 1 and next to it: the parameters B1 and B2 are clamped.
  for (int64_t offset : {one, -one, one - (1 << 14), -one - (1 << 14), -one - (1 << 14) - 1})
    for (uint32_t pair : {reg_au_lo + 16, reg_au_lo + 40}) {
      if (bench.failed()) return;
      pass_through(bench);
      bench.write_pair(pair, offset);
      bench.sample(0, 0);
      bench.drain();
      bench.read(reg_flags);
      bench.read(reg_b1);
      bench.read(reg_b2);
    }
}

}  // namespace capsoc::regress
