// Windows, records, alarm and freeze of the turn judge.
#include <array>
#include <cmath>

#include "base/constants.h"
#include "coprocessor/register_map.h"
#include "regress/scenario.h"
#include "regress/shaft.h"

namespace capsoc::regress {

using namespace coprocessor;

namespace {

constexpr int64_t turn_48 = int64_t{1} << 48;
constexpr uint32_t limits = 51 << judge_alarm_limit_shift | 51;
constexpr int turn_samples = 32;

uint32_t judge_word(unsigned turns, bool count = false) {
  return limits | turns << judge_turns_shift | (count ? judge_count : 0);
}

constexpr uint32_t source(unsigned number) {
  return number << ctrl_ref_shift;
}

void good_and_bad_turns(Bench& bench, unsigned from, double direction) {
  const double step = direction / turn_samples;
  for (unsigned turns = 0; turns < 4; ++turns) {
    Shaft shaft(bench, ctrl_calib | source(from) | ctrl_ie_turn | ctrl_ie_lock, step);
    bench.write(reg_judge, judge_word(turns));
    shaft.move(70, step);
    shaft.read();
    shaft.move(4 * turn_samples, step);
    shaft.read();
    shaft.move(1, step, 1, true);  // clipped: its turn is not good
    shaft.move(2 * turn_samples, step);
    shaft.read();
    shaft.move(1, step, 0);  // no angle, and the radius is 0
    shaft.move(turn_samples, step);
    shaft.read();
    shaft.move(1, step, 1.5);
    shaft.move(turn_samples, step);
    shaft.read();
    shaft.move(5 * turn_samples, step);
    shaft.read();
  }
}

// Travel of a window at the borders of what is one turn, and far beyond.
void windings(Bench& bench) {
  for (double units : {59.5, 60.5, 61.5, 66.5, 67.5, 68.5, 95.5, 96.5, 127.0, 128.0, 190.0, 0.0})
    for (double direction : {1.0, -1.0}) {
      if (bench.failed()) return;
      Shaft shaft(bench, ctrl_calib, 1.0 / turn_samples);
      shaft.move(turn_samples + 1, direction / turn_samples);
      shaft.move(3 * turn_samples, direction * units / 64 / turn_samples);
      shaft.read();
    }
}

// One turn at the window's end, and more on the way there: within 1.5 turns, about it, and beyond.
void there_and_back(Bench& bench) {
  constexpr double step = 1.0 / 16;
  for (int most : {20, 23, 24, 25, 28, 34})
    for (double direction : {1.0, -1.0}) {
      if (bench.failed()) return;
      Shaft shaft(bench, ctrl_calib, 1.0 / 64);
      for (unsigned window = 0; window < 2; ++window) {
        shaft.move(most, direction * step);
        shaft.move(most - 16, -direction * step);
        shaft.move(64 - 2 * most + 16, 0);
      }
      shaft.move(1, 0);
      shaft.read();
    }
}

// The vector comes back to where it was: exactly one turn of the angle.
void exact_turns(Bench& bench) {
  for (bool forward : {true, false}) {
    Shaft shaft(bench, ctrl_calib | source(2), 0, {0.5, 0.5, 0, 0, 0});
    const std::array<std::array<uint32_t, 2>, 4> corners = {
        {{0, q31_word(0.5)}, {q31_word(0.5), 0}, {0, q31_word(-0.5)}, {q31_word(-0.5), 0}}};
    for (unsigned i = 0; i < 30; ++i) {
      const auto& corner = corners[(forward ? i : 4000 - i) % 4];
      bench.sample(corner[0], corner[1]);
      bench.wait(bench.tick());
    }
    shaft.read();
  }
}

void windows_by_count(Bench& bench) {
  const double step = 1.0 / turn_samples;
  // Before, with and after the turn's own end.
  for (uint32_t limit : {1u, 2u, 8u, 31u, 32u, 33u, 34u, 100u})
    for (unsigned from : {0u, 1u, 2u})
      for (bool count : {false, true}) {
        if (bench.failed()) return;
        Shaft shaft(bench, ctrl_calib | source(from) | ctrl_ie_turn, step);
        bench.write(reg_judge, judge_word(1, count));
        bench.write(reg_turn_limit, limit);
        shaft.move(105, step);
        shaft.read();
        shaft.move(40, 0);
        shaft.read();
      }
}

void mirrored_and_saturated(Bench& bench) {
  const double step = 1.0 / turn_samples;
  // With the angle as reference nothing else is wrong with a mirrored turn.
  for (unsigned from : {0u, 1u, 2u}) {
    Shaft mirrored(bench, ctrl_calib | source(from), step, {0.5, 0.5, 0, 0, 3});
    bench.write(reg_judge, judge_word(1));
    mirrored.move(3 * turn_samples + 6, step);
    mirrored.read();
  }
  Shaft saturated(bench, ctrl_calib, step);
  saturated.move(30, step);
  bench.write_pair(reg_au_lo + 16, int64_t{3} << 45);  // c_u 1.5: the error saturates
  saturated.move(2, step);
  bench.write_pair(reg_au_lo + 16, 0);
  saturated.move(70, step);
  saturated.read();
}

// Windows in which a single thing is wrong: a sample without an angle, or one octant that is
// missing.
void one_reason(Bench& bench) {
  const ShaftSensor centred = {0.5, 0.5, 0, 0, 0};
  for (unsigned from : {0u, 1u, 2u}) {
    if (bench.failed()) return;
    Shaft zero(bench, ctrl_calib | source(from), 1.0 / turn_samples, centred);
    bench.write(reg_judge, 1u << judge_turns_shift | judge_count);  // no limit: 0 is no radius
    bench.write(reg_turn_limit, turn_samples);
    zero.move(3 * turn_samples + 5, 1.0 / turn_samples);
    zero.read();
    zero.move(1, 1.0 / turn_samples, 0);
    zero.move(turn_samples - 1, 1.0 / turn_samples);
    zero.read();
    zero.move(turn_samples, 1.0 / turn_samples);
    zero.read();
    Shaft missing(bench, ctrl_calib | source(from), 0.125, centred);
    bench.write(reg_judge, judge_word(1, true));
    bench.write(reg_turn_limit, 7);
    for (unsigned i = 0; i < 8; ++i) {  // each window misses another octant
      missing.move(7, 0.125);
      missing.read();
    }
    bench.write(reg_turn_limit, 8);
    missing.move(16, 0.125);
    missing.read();
  }
}

}  // namespace

void run_turns(Bench& bench, Random&, const Budget&) {
  for (unsigned from : {0u, 1u, 2u})
    for (double direction : {1.0, -1.0}) good_and_bad_turns(bench, from, direction);
}

void run_windings(Bench& bench, Random&, const Budget&) {
  windings(bench);
  there_and_back(bench);
  exact_turns(bench);
}

void run_windows(Bench& bench, Random&, const Budget&) {
  one_reason(bench);
  mirrored_and_saturated(bench);
  windows_by_count(bench);
}

void run_turn_count(Bench& bench, Random&, const Budget&) {
  // Every sample a window: TURN_COUNT passes 255.
  const double step = 1.0 / turn_samples;
  Shaft shaft(bench, ctrl_calib, step);
  bench.write(reg_turn_limit, 1);
  shaft.move(258, step);
  shaft.read();
  // The clipped ones are counted to 255; then a limit that is below the count already.
  bench.write(reg_judge, judge_word(0, true));
  bench.write(reg_turn_limit, 0);
  shaft.move(260, step, 1, true);
  bench.write(reg_turn_limit, 20);
  shaft.move(2, step);
  shaft.read();
}

void run_limit_bits(Bench& bench, Random& random, const Budget&) {
  // Each bit of a limit decides; the other sources' words are in the pipeline at the same time.
  for (unsigned bit = 0; bit < 8; ++bit)
    for (int beside : {-3, -2, -1, 0, 1, 2, 3}) {
      if (bench.failed()) return;
      const uint32_t n = 1u << bit;
      Shaft shaft(bench, ctrl_calib, 0, {0.5, 0.5, 0, 0, 0});
      bench.write(reg_judge, n << judge_alarm_limit_shift | n | judge_count);
      bench.write(reg_turn_limit, 3);
      // DET is 2^29: the limit n 2^21, AMPLITUDE half the sample.
      for (int sign : {1, -1}) {
        const int64_t deviation = (int64_t{n} << 21) + beside;
        const int64_t u = 2 * ((int64_t{1} << 29) + sign * deviation);
        if (u > INT32_MAX) continue;
        for (unsigned i = 0; i < 3; ++i) {
          bench.sample(static_cast<uint32_t>(u), random.word32() & 1);
          bench.wait(bench.tick());
        }
        shaft.read();
      }
    }
  for (uint32_t n : {0u, 255u}) {
    Shaft shaft(bench, ctrl_calib, 1.0 / turn_samples);
    bench.write(reg_judge, n << judge_alarm_limit_shift | n);
    for (double scale : {0.001, 1.9, 1.0}) {
      shaft.move(40, 1.0 / turn_samples, scale);
      shaft.read();
    }
  }
}

void run_turn_limit(Bench& bench, Random&, const Budget&) {
  // A bit of the limit that is lost or too many ends a window at once or never: each alone, with
  // a small limit next to it.
  for (unsigned bit = 0; bit < 32 && !bench.failed(); ++bit) {
    Shaft shaft(bench, ctrl_calib, 0);
    bench.write(reg_turn_limit, 1u << bit);
    shaft.move(6, 0);
    shaft.read();
    bench.write(reg_turn_limit, 1u << bit | 3);
    shaft.move(4, 0);
    shaft.read();
    bench.write(reg_turn_limit, 3);
    shaft.move(4, 0);
    shaft.read();
  }
}

void run_passes(Bench& bench, Random&, const Budget&) {
  // The reference passes 0 by a hair, either way; and it stands.
  for (int64_t frequency : {turn_48 / 8, -turn_48 / 8, int64_t{1}, int64_t{-1}, int64_t{0}})
    for (int64_t phase : {int64_t{0}, int64_t{1}, turn_48 - 1, turn_48 / 8, turn_48 * 7 / 8,
                          turn_48 * 7 / 8 - 1, turn_48 / 8 - 1})
      for (unsigned from : {0u, 1u, 2u}) {
        Shaft shaft(bench, ctrl_calib | source(from), 0);
        bench.write_pair(reg_freq_lo, frequency);
        bench.write_pair(reg_phase_lo, phase);
        bench.write(reg_loop, from == 1 && phase % 2 == 0 ? 0 : 0x0A04);
        shaft.move(9, 0.125);
        shaft.read();
      }
}

void run_residue_limit(Bench& bench, Random&, const Budget&) {
  // A shaft at rest and a reference that stands, 1/16 turn off either way, and a unit off it.
  for (int sign : {1, -1})
    for (int beside : {-1, 0, 1}) {
      if (bench.failed()) return;
      Shaft shaft(bench, ctrl_calib, 0);
      bench.write(reg_turn_limit, 2);
      bench.write(reg_judge, judge_word(1, true));
      shaft.move(1, 0);
      bench.drain();
      const auto found = static_cast<int32_t>(bench.read(reg_residue));
      const uint32_t phase = static_cast<uint32_t>(found) -
                             static_cast<uint32_t>(sign * ((int32_t{1} << 28) + beside));
      bench.write_pair(reg_phase_lo, int64_t{phase} << 16);
      shaft.move(3, 0);
      shaft.read();
    }
  // Locked, then one sample that is wrong in one way alone.
  const double step = 1.0 / turn_samples;
  for (uint32_t from : {0u, 1u})
    for (unsigned way = 0; way < 4; ++way) {
      if (bench.failed()) return;
      Shaft shaft(bench, ctrl_calib | source(from) | ctrl_ie_lock, step);
      shaft.move(4 * turn_samples, step);
      shaft.read();
      if (way == 3) bench.write_pair(reg_phase_lo, turn_48 / 4);
      shaft.move(1, step, way == 0 ? 1.5 : way == 2 ? 0 : 1, way == 1);
      shaft.read();
      for (unsigned i = 0; i < 6; ++i) {
        shaft.move(turn_samples / 2, step);
        shaft.read();
      }
    }
}

void run_alarm(Bench& bench, Random& random, const Budget&) {
  const double step = 1.0 / turn_samples;
  const uint32_t learning = ctrl_calib | ctrl_demod | ctrl_ie_alarm;
  for (int glitches : {1, 15, 16, 17, 40})
    for (uint32_t freeze : {0u, ctrl_freeze}) {
      if (bench.failed()) return;
      Shaft shaft(bench, learning | freeze, step);
      shaft.move(70, step);
      shaft.read();
      shaft.move(glitches, step, 0.5);
      bench.drain();
      bench.interrupt();
      bench.read(reg_status);
      shaft.move(3, step);
      shaft.read();  // and the flag is cleared: it comes back while there is an alarm
      for (unsigned i = 0; i < 20; ++i) {
        shaft.move(1, step);
        shaft.read();
      }
    }
  // Without turns to wait for, LOCK falls with the alarm itself and comes back with its end.
  {
    Shaft shaft(bench, learning | ctrl_ie_lock, step);
    bench.write(reg_judge, judge_word(0));
    shaft.move(70, step);
    shaft.read();
    shaft.move(20, step, 0.5);
    shaft.read();
    shaft.move(40, step);
    shaft.read();
  }
  // By CLIP alone, in turn with good ones, and with the flag cleared at every edge of a sample's
  // way.
  Shaft shaft(bench, learning | ctrl_freeze, step);
  for (unsigned i = 0; i < 30; ++i) shaft.move(1, step, 1, i % 3 != 0);
  shaft.read();
  for (unsigned edge = 0; edge < bench.scaled(200) && !bench.failed(); ++edge) {
    shaft.move(20, step, 0.3);
    bench.drain();
    const uint64_t begin = bench.edge();
    shaft.move(3, step, 0.3);
    bench.wait_until(begin + edge);
    bench.write(reg_flags, flag_alarm);
    if (edge % 2 == 0) bench.write(reg_ctrl, learning | ctrl_adc | (edge % 4 ? ctrl_freeze : 0));
    bench.drain();
    bench.read(reg_status);
    if (edge % 2 == 0) bench.write(reg_ctrl, learning | ctrl_adc | ctrl_freeze);
  }
  // Settings at every edge of a sample's way.
  for (unsigned edge = 0; edge < bench.scaled(200) && !bench.failed(); ++edge) {
    const uint64_t begin = bench.edge();
    shaft.move(1, step, edge % 3 == 0 ? 1.3 : 1);
    bench.wait_until(begin + edge);
    bench.write(
        edge % 2 == 0 ? reg_judge : reg_turn_limit,
        edge % 2 == 0 ? random.word32() & judge_writable : static_cast<uint32_t>(random.below(4)));
    shaft.read();
  }
}

}  // namespace capsoc::regress
