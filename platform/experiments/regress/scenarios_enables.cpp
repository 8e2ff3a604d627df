// What full bins of levels and accesses did not imply: interrupts that are enabled after their flag
// was raised, and writes of some of a word's bytes.
#include "capsoc_registers.h"
#include "coprocessor/device.h"
#include "coprocessor/register_map.h"
#include "regress/scenario.h"

namespace capsoc::regress {

using namespace coprocessor;

namespace {

constexpr uint32_t learning_on = ctrl_adc | ctrl_demod | ctrl_calib;
constexpr uint32_t interrupts[] = {ctrl_ie_result, ctrl_ie_lock,  ctrl_ie_error,
                                   ctrl_ie_turn,   ctrl_ie_alarm, ctrl_ie_safety};
constexpr uint32_t every_interrupt =
    ctrl_ie_result | ctrl_ie_lock | ctrl_ie_error | ctrl_ie_turn | ctrl_ie_alarm | ctrl_ie_safety;

void from_reset(Bench& bench) {
  bench.drain();
  bench.wait(2);
  bench.write(reg_ctrl, ctrl_srst);
}

/// Raises every flag that an arithmetic can raise, with all interrupts masked. These are: LOCK
/// gained, diverged, lost samples, mirrored, saturated, without an angle, a refused write. With
/// `alarm` also an alarm of clipped samples, which clears LOCK.
void raise_all(Bench& bench, Random& random, bool alarm) {
  from_reset(bench);
  bench.write(reg_judge, 0);       // LOCK by the average alone
  bench.write(reg_turn_limit, 1);  // each sample ends its window
  bench.write(reg_lock_threshold, ~0u);
  bench.write(reg_diverge_threshold, 0);
  bench.write(reg_ctrl, learning_on);
  constexpr unsigned settled = 66, glitches = 18;
  for (unsigned i = 0; i < settled + (alarm ? glitches : 0) && !bench.failed(); ++i) {
    bench.sample(random.word32(), random.word32(), i >= settled);
    bench.wait(bench.tick() + 1);
  }
  bench.drain();
  bench.write(reg_beta, 1u << 31);
  bench.write_pair(reg_au_lo, -(int64_t{1} << 45));
  bench.write(reg_a1, 1u << 31);
  for (unsigned i = 0; i < 3; ++i) bench.sample(0x80000000u, 0x80000000u, true);
  bench.drain();
  for (uint32_t pair = reg_au_lo; pair < reg_cv_hi; pair += 8) bench.write_pair(pair, 0);
  bench.write(reg_a1, 0);
  bench.write(reg_a2, 0);
  // LOOP, and SAFETY itself, with the wrong parity bit.
  bench.write(reg_safety, safety_bad_parity);
  bench.write(reg_loop, description::LOOP_reset);
  bench.write(reg_safety, safety_parity | safety_misfit | safety_jump | safety_missed |
                              safety_error_limit_mask | safety_step_limit_mask);
  bench.sample(0x40000000u, 0x20000000u);
  bench.sample(0, 0);
  bench.drain();
  bench.read(reg_flags);
}

/// The present flags under each enable alone and under none.
void look_through(Bench& bench) {
  for (uint32_t enable : interrupts) {
    for (uint32_t ctrl : {learning_on | enable, learning_on}) {
      bench.write(reg_ctrl, ctrl);
      bench.interrupt();
    }
  }
}

}  // namespace

void run_enables(Bench& bench, Random& random, const Budget&) {
  // One flag left of all, raised while masked.
  for (uint32_t bit = 0; bit < flag_count && !bench.failed(); ++bit) {
    raise_all(bench, random, true);
    bench.write(reg_flags, flags_all & ~(1u << bit));
    bench.interrupt();
    look_through(bench);
    // Masked and unmasked while it is set; cleared while enabled, and not raised again.
    for (uint32_t enable : interrupts) {
      bench.write(reg_ctrl, learning_on | enable);
      bench.write(reg_ctrl, learning_on | (every_interrupt & ~enable));
      bench.interrupt();
    }
    bench.write(reg_flags, 1u << bit);
    look_through(bench);
  }
  // The enable comes and goes at the edge of the commit that raises the flag, and one edge before
  // and after it.
  for (uint32_t enable : interrupts)
    for (bool comes : {true, false})
      // One edge before the result, at it, one after it.
      for (const uint64_t edge : {uint64_t{0}, uint64_t{1}, uint64_t{2}}) {
        if (bench.failed()) return;
        raise_all(bench, random, enable != ctrl_ie_lock);
        bench.write(reg_ctrl, comes ? learning_on : learning_on | enable);
        bench.write(reg_flags, flags_all);
        bench.drain();
        bench.wait(2);
        bench.write(reg_lock_threshold, 0);  // LOCK falls
        bench.sample(random.word32(), random.word32(), true);
        bench.wait_until(bench.edge() + bench.latency() - 1);
        bench.wait(edge);
        bench.write(reg_ctrl, comes ? learning_on | enable : learning_on);
        bench.interrupt();
        bench.drain();
        bench.wait(2);
        bench.read(reg_flags);
        look_through(bench);
      }
}

void run_strobes(Bench& bench, Random& random, const Budget&) {
  namespace description = registers::coprocessor;
  from_reset(bench);
  bench.write(reg_ctrl, learning_on);
  for (const auto& entry : description::table) {
    if (bench.failed()) return;
    // Words that would show: a sample, a LOAD, a reset, flags, a stage of a pair.
    bench.write(reg_soft_u, random.word32());
    bench.write(reg_a1, 1u << 31);
    bench.drain();
    for (uint8_t strobes = 0; strobes < all_strobes; ++strobes) {
      bench.write(entry.offset, ~0u, strobes);
      bench.write(entry.offset, random.word32(), strobes);
    }
    bench.read(entry.offset);
    if (is_pair(entry.offset)) {
      // A stage and a latch that a refused write must leave.
      const uint32_t low = entry.offset & ~4u;
      bench.write(low, random.word32());
      bench.read(low | 4);
      bench.write(low, random.word32(), static_cast<uint8_t>(random.below(all_strobes)));
      bench.write(low | 4, random.word32(), static_cast<uint8_t>(random.below(all_strobes)));
      bench.read(low);
      bench.write(low | 4, random.word32());
      bench.read(low | 4);
      bench.read(low);
    }
    bench.read(reg_status);
    bench.read(reg_flags);
  }
  for (const auto& entry : description::table) bench.read(entry.offset);
  // Where nothing is, and while samples pass.
  for (unsigned i = 0; i < 400 && !bench.failed(); ++i) {
    const auto strobes = static_cast<uint8_t>(random.below(all_strobes));
    bench.write(static_cast<uint32_t>(random.below(0x100)), random.word32(), strobes);
    if (i % 8 == 0) bench.sample(random.word32(), random.word32());
    bench.wait(random.below(bench.scaled(40)));
  }
  bench.drain();
  for (const auto& entry : description::table) bench.read(entry.offset);
}

}  // namespace capsoc::regress
