// Random traffic. All of these are one loop with other weights.
#include <algorithm>
#include <array>

#include "coprocessor/register_map.h"
#include "regress/scenario.h"
#include "regress/signal.h"

namespace capsoc::regress {

using namespace coprocessor;

namespace {

constexpr std::array<uint32_t, 17> results = {
    reg_status,    reg_flags,     reg_raw_u,         reg_raw_v,   reg_cal_s,   reg_cal_c,
    reg_angle,     reg_err_u,     reg_err_v,         reg_residue, reg_samples, reg_early_count,
    reg_ref_phase, reg_amplitude, reg_error_average, reg_beta,    reg_a1};

uint64_t draw_spacing(const Bench& bench, Random& random, unsigned kind) {
  const uint64_t tick = bench.tick(), latency = bench.latency();
  switch (kind) {
    case 0:
      return tick;
    case 1:
      return random.between(tick, bench.scaled(40));
    case 2:
      return random.between(1, bench.scaled(40));
    case 3:
      return random.between(tick - 1, tick + 1);
    case 4:
      return random.between(latency - 1, latency + 2);
    case 5:
      return random.between(1, bench.scaled(200));
    default:
      return random.between(bench.scaled(24), bench.scaled(72));
  }
}

// An offset as software with bugs would use it.
uint32_t draw_offset(Random& random) {
  const uint64_t kind = random.below(64);
  if (kind == 0) return static_cast<uint32_t>(random.below(0x1000));
  if (kind == 1) return static_cast<uint32_t>(0x100 + 4 * random.below(0x3C0));
  return static_cast<uint32_t>(random.below(reg_last / 4 + 1) * 4);
}

// A control word; REF 3 is among them.
uint32_t draw_ctrl(Random& random) {
  uint32_t word = random.word32() & (ctrl_writable & ~ctrl_adc);
  if (random.chance(0.9)) word |= ctrl_adc;
  if (random.chance(0.7)) word |= ctrl_demod;
  if (random.chance(0.8)) word |= ctrl_calib;
  return word;
}

uint32_t draw_step(Random& random) {
  switch (random.below(8)) {
    case 0:
      return static_cast<uint32_t>(random.below(3));
    case 1:
      return INT32_MAX - static_cast<uint32_t>(random.below(3));
    case 2:
      return corner32(random) & INT32_MAX;
    default:
      return (random.word32() & INT32_MAX) >> random.below(31);
  }
}

// Threshold near the sizes that averages have.
uint32_t draw_threshold(Random& random) {
  return random.chance(0.1) ? corner32(random) : random.word32() >> random.below(32);
}

int64_t draw_weight(Random& random) {
  const auto word = static_cast<int64_t>(static_cast<int32_t>(corner32(random)));
  return word * (int64_t{1} << 15) + static_cast<int64_t>(random.below(65536)) - 32768;
}

// Limits, windows and turns of every kind; half of them as LOCK was without turns.
void configure_judge(Bench& bench, Random& random) {
  if (random.chance(0.5)) return bench.write(reg_judge, random.chance(0.5) ? 0 : 0x3333);
  bench.write(reg_judge, random.word32() & (random.chance(0.8) ? judge_writable : ~0u));
  bench.write(reg_turn_limit, random.word32() >> random.below(32));
}

// What software would set up before a measurement: a source, steps, gains, a frequency.
void configure(Bench& bench, Random& random, const Signal& signal) {
  bench.write(reg_ctrl, draw_ctrl(random) | (random.chance(0.9) ? ctrl_adc : 0));
  const uint32_t step = draw_step(random);
  const bool alike = random.chance(0.5);
  for (uint32_t offset = reg_step_au; offset <= reg_step_cv; offset += 4)
    if (random.chance(0.5)) bench.write(offset, alike ? step : draw_step(random));
  if (random.chance(0.5))
    bench.write(reg_loop, static_cast<uint32_t>(random.below(32) | random.below(32) << 8));
  if (random.chance(0.5)) bench.write(reg_lock_threshold, draw_threshold(random));
  if (random.chance(0.5)) bench.write(reg_diverge_threshold, draw_threshold(random));
  if (random.chance(0.5)) configure_judge(bench, random);
  const uint64_t frequency = random.below(4);
  if (frequency < 2) bench.write_pair(reg_freq_lo, signal.frequency());
  if (frequency == 2)
    bench.write_pair(reg_freq_lo, static_cast<int64_t>(random.word()) >> random.between(16, 48));
  if (random.chance(0.2)) bench.write_pair(reg_phase_lo, static_cast<int64_t>(random.word() >> 16));
  if (random.chance(0.2))
    for (uint32_t pair = reg_au_lo; pair < reg_cv_hi; pair += 8)
      bench.write_pair(pair, draw_weight(random));
}

void load(Bench& bench, Random& random) {
  for (uint32_t offset = reg_a1; offset <= reg_phi; offset += 4)
    if (random.chance(0.5))
      bench.write(offset, offset <= reg_a2 ? corner32(random) & INT32_MAX : corner32(random));
  bench.write(reg_cmd, cmd_load);
}

struct Habits {
  bool any_offset = false;  // accesses beyond what a driver does
  double soft_reset = 0;    // each: chance in place of an access
  double pin_reset = 0;
  double load = 0;
  double reconfigure = 0;      // chance at a sample
  double software = 0;         // chance that software submits the sample
  unsigned spacing_kinds = 7;  // of draw_spacing()
};

void access(Bench& bench, Random& random, const Habits& habits) {
  if (random.chance(habits.soft_reset)) {
    bench.write(reg_ctrl, ctrl_srst | random.word32());
    return bench.write(reg_ctrl, draw_ctrl(random) | ctrl_adc);
  }
  if (random.chance(habits.pin_reset)) {
    bench.pin_reset();
    return bench.write(reg_ctrl, draw_ctrl(random) | ctrl_adc);
  }
  if (random.chance(habits.load)) return load(bench, random);
  if (!habits.any_offset) {
    if (random.chance(0.1)) return bench.write(reg_flags, random.word32());
    bench.read(results[random.below(results.size())]);
    return;
  }
  const uint32_t offset = draw_offset(random);
  if (random.chance(0.05)) bench.interrupt();
  if (random.chance(0.5)) {
    bench.read(offset, random.chance(0.05));
    return;
  }
  uint32_t value = random.chance(0.5) ? corner32(random) : random.word32();
  if (offset == reg_ctrl) value = draw_ctrl(random) | (random.word32() & 0x7FFFE0C0u);
  if (offset == reg_cmd && random.chance(0.7)) value &= ~cmd_load;
  if (offset >= reg_step_au && offset <= reg_step_cv && random.chance(0.8))
    value = draw_step(random);
  const bool some = random.chance(0.05);  // of the word's bytes
  bench.write(offset, value, some ? static_cast<uint8_t>(random.below(16)) : all_strobes);
}

void run(Bench& bench, Random& random, const Budget& budget, const Habits& habits) {
  Signal signal(random);
  unsigned spacing_kind = 0;
  uint64_t next = bench.edge() + 10;
  bench.write(reg_ctrl, ctrl_adc | ctrl_demod | ctrl_calib);
  const Bench::Counts& done = bench.counts();
  const uint64_t all_accesses = done.accesses + budget.accesses;
  while ((done.samples < budget.samples || done.accesses < all_accesses) && !bench.failed()) {
    if (done.samples == 1 || random.chance(habits.reconfigure)) {
      signal = Signal(random);
      spacing_kind = static_cast<unsigned>(random.below(habits.spacing_kinds));
      configure(bench, random, signal);
      next = std::max(next, bench.edge());
    }
    const uint64_t space = draw_spacing(bench, random, spacing_kind);
    const uint64_t left = budget.samples > done.samples ? budget.samples - done.samples : 1;
    const uint64_t due = all_accesses > done.accesses ? all_accesses - done.accesses : 0;
    uint64_t accesses = due / left;
    if (random.below(left) < due % left) ++accesses;
    accesses = std::min<uint64_t>(accesses, 24);
    bench.wait_until(next);
    const Sample sample = signal.next(random);
    if (random.chance(habits.software))
      bench.soft_sample(sample.u, sample.v);
    else
      bench.sample(sample.u, sample.v, sample.clip);
    next += space;
    for (uint64_t i = 0; i < accesses; ++i) {
      if (random.chance(0.7) && next > bench.edge())
        bench.wait(random.below((next - bench.edge()) / (accesses - i) + 1));
      access(bench, random, habits);
    }
    next = std::max(next, bench.edge());
  }
  bench.drain();
  for (uint32_t offset = 0; offset <= reg_last; offset += 4) bench.read(offset);
}

}  // namespace

void run_stream(Bench& bench, Random& random, const Budget& budget) {
  Habits habits;
  habits.reconfigure = 0.003;
  habits.soft_reset = habits.load = 0.001;
  run(bench, random, budget, habits);
}

void run_noise(Bench& bench, Random& random, const Budget& budget) {
  Habits habits;
  habits.reconfigure = 0.01;
  habits.spacing_kinds = 2;
  run(bench, random, budget, habits);
}

void run_traffic(Bench& bench, Random& random, const Budget& budget) {
  Habits habits;
  habits.any_offset = true;
  habits.soft_reset = habits.pin_reset = 0.0005;
  habits.load = 0.002;
  habits.reconfigure = 0.01;
  habits.software = 0.1;
  run(bench, random, budget, habits);
}

void run_interrupted(Bench& bench, Random& random, const Budget& budget) {
  Habits habits;
  habits.any_offset = true;
  habits.soft_reset = habits.pin_reset = 0.02;
  habits.load = 0.05;
  habits.reconfigure = 0.05;
  run(bench, random, budget, habits);
}

void run_software(Bench& bench, Random& random, const Budget& budget) {
  Habits habits;
  habits.software = 1;
  habits.reconfigure = 0.01;
  habits.soft_reset = 0.002;
  run(bench, random, budget, habits);
}

}  // namespace capsoc::regress
