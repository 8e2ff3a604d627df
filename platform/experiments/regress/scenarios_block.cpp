// Block learning: what a window's end makes of a block, at every distance of the samples, and what
// breaks one.
#include <array>

#include "coprocessor/register_map.h"
#include "regress/scenario.h"
#include "regress/shaft.h"

namespace capsoc::regress {

using namespace coprocessor;

namespace {

constexpr int block_samples = 32;
constexpr double block_turn = 1.0 / block_samples;
constexpr double eighth = 0.126;
constexpr uint32_t judging = 51 << judge_alarm_limit_shift | 51 | 1u << judge_turns_shift;
constexpr uint32_t blocks = ctrl_calib | ctrl_demod | ctrl_block;

void set_steps(Bench& bench, uint32_t step, uint32_t constant) {
  for (uint32_t offset = reg_step_au; offset <= reg_step_cv; offset += 4) bench.write(offset, step);
  bench.write(reg_step_au + 8, constant);
  bench.write(reg_step_cv, constant);
}

// Normal equations of a turn of 32 samples.
void set_turn_steps(Bench& bench) {
  set_steps(bench, 1u << 27, 1u << 26);
}

void read_coefficients(Bench& bench) {
  bench.drain();
  for (uint32_t high = reg_au_lo + 4; high <= reg_cv_hi; high += 8) {
    bench.read(high);
    bench.read(high - 4);
  }
  bench.read(reg_status);
  bench.read(reg_flags);
  bench.write(reg_flags, flags_all);
}

// Good turns, and turns that one sample spoils; learnt with the guard and without.
void good_and_bad_windows(Bench& bench, uint32_t ctrl) {
  Shaft shaft(bench, ctrl, block_turn);
  set_turn_steps(bench);
  bench.write(reg_judge, judging);
  const auto turns = [&](int n) {
    for (int i = 0; i < n; ++i) {
      shaft.move(block_samples, block_turn, 1.05);
      read_coefficients(bench);
    }
  };
  turns(3);
  shaft.move(1, block_turn, 1, true);
  turns(3);
  shaft.move(1, block_turn, 0);  // no angle
  turns(3);
  shaft.move(1, block_turn, 1.6);
  turns(3);
  shaft.move(2 * block_samples, 0, 1.05);  // at rest
  read_coefficients(bench);
  turns(3);
}

// Windows by count, so short that the pipeline holds several, and at every distance of the samples.
void windows_in_the_pipeline(Bench& bench, Random& random, uint32_t ctrl, unsigned length,
                             unsigned distance) {
  Shaft shaft(bench, ctrl, 0.13);
  set_steps(bench, 1u << 28, 1u << 27);
  bench.write(reg_judge, judging | judge_count);
  bench.write(reg_turn_limit, length);
  for (int i = 0; i < 14; ++i) {
    shaft.move(1, 0.13, 0.9 + 0.01 * (random.word32() & 15));
    bench.wait(distance);
  }
  read_coefficients(bench);
}

// What happens to a block under way.
// Windows of nine samples that see all octants.
void interrupted_blocks(Bench& bench, Random& random, int at) {
  for (int what = 0; what < 10; ++what)
    for (uint32_t guard : {0u, ctrl_guard}) {
      if (bench.failed()) return;
      Shaft shaft(bench, blocks | guard, eighth);
      set_steps(bench, 1u << 28, 1u << 27);
      bench.write(reg_judge, judging | judge_count);
      bench.write(reg_turn_limit, 9);
      shaft.move(at, eighth, 1.03);
      switch (what) {
        case 0:  // LMS for a while
          bench.write(reg_ctrl, ctrl_adc | ctrl_calib | ctrl_demod | guard);
          shaft.move(3, eighth, 1.03);
          bench.write(reg_ctrl, ctrl_adc | blocks | guard);
          break;
        case 1:  // nothing learns
          bench.write(reg_ctrl, ctrl_adc | ctrl_calib | ctrl_block | guard);
          shaft.move(2, eighth, 1.03);
          bench.write(reg_ctrl, ctrl_adc | blocks | guard);
          break;
        case 2:
          bench.write_pair(reg_au_lo, (int64_t{1} << 45) + random.word32());
          break;
        case 3:
          bench.write(reg_cmd, cmd_load);
          bench.drain();
          break;
        case 4:
          bench.write(reg_ctrl, ctrl_srst);
          bench.write(reg_ctrl, ctrl_adc | blocks | guard);
          break;
        case 5:
          bench.write(reg_cmd, cmd_phase0);
          break;
        case 6:  // its window times out
          bench.write(reg_judge, judging);
          break;
        case 7:  // the guard comes or goes
          bench.write(reg_ctrl, ctrl_adc | blocks | (guard ^ ctrl_guard));
          shaft.move(1, eighth, 1.03, true);
          break;
        case 8:  // an alarm freezes
          bench.write(reg_ctrl, ctrl_adc | blocks | guard | ctrl_freeze);
          shaft.move(17, eighth, 1.03, true);
          bench.write(reg_flags, flags_all);
          break;
        default:  // the window ends in the middle of a gap
          bench.wait(random.word32() % 400);
      }
      shaft.move(9, eighth, 1.03);
      read_coefficients(bench);
      bench.write(reg_judge, judging | judge_count);
      shaft.move(18, eighth, 1.03);
      read_coefficients(bench);
    }
}

// Sums at both ends of their word, in either channel.
void full_sums(Bench& bench, Random& random) {
  for (double scale : {3.0, -3.0}) {
    Shaft shaft(bench, blocks, 0.01);
    set_steps(bench, 0x7FFFFFFF - (random.word32() & 0xFFFF), 0x7FFFFFFF);
    bench.write(reg_judge, judging | judge_count);
    bench.write(reg_turn_limit, 12);
    shaft.move(20, 0.01, scale);
    read_coefficients(bench);
    shaft.move(20, 0.01, scale);
    read_coefficients(bench);
  }
}

}  // namespace

void run_blocks(Bench& bench, Random&, const Budget&) {
  for (unsigned source : {0u, 1u, 2u})
    for (uint32_t guard : {0u, ctrl_guard})
      good_and_bad_windows(bench, blocks | guard | source << ctrl_ref_shift);
}

void run_block_windows(Bench& bench, Random& random, const Budget&) {
  const std::array<uint32_t, 4> modes = {blocks, blocks | ctrl_guard, blocks | 2u << ctrl_ref_shift,
                                         blocks | ctrl_guard | 2u << ctrl_ref_shift};
  unsigned i = 0;
  for (unsigned length : {1u, 2u, 3u, 5u})
    for (unsigned distance : {0u, 1u, 32u, 33u, 64u, 96u, 160u}) {
      if (bench.failed()) return;
      windows_in_the_pipeline(bench, random, modes.at(i++ % modes.size()), length, distance);
    }
}

void run_block_sums(Bench& bench, Random& random, const Budget&) {
  full_sums(bench, random);
}

void run_block_changes(Bench& bench, Random& random, const Budget&) {
  for (int at : {9, 1, 8, 10}) interrupted_blocks(bench, random, at);
}

}  // namespace capsoc::regress
