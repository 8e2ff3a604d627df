// The register description against the registers.
#include "capsoc_registers.h"
#include "coprocessor/register_map.h"
#include "regress/scenario.h"

namespace capsoc::regress {

using namespace coprocessor;

namespace {

namespace description = registers::coprocessor;

constexpr uint32_t block_end = 0x1000;

void read_all(Bench& bench) {
  for (const auto& entry : description::table) bench.read(entry.offset, true);
  for (const auto& entry : description::table) bench.read(entry.offset);
}

void clean(Bench& bench) {
  bench.drain();
  bench.wait(2);
  bench.write(reg_ctrl, ctrl_srst);
}

}  // namespace

void run_registers(Bench& bench, Random& random, const Budget&) {
  read_all(bench);  // as power-on leaves them
  clean(bench);
  read_all(bench);
  // One register at a time, from reset: ones, zeros, each bit, then all others again.
  for (const auto& entry : description::table) {
    if (bench.failed()) return;
    clean(bench);
    for (unsigned bit = 0; bit < 36; ++bit) {
      const uint32_t value = bit < 32    ? 1u << bit
                             : bit == 32 ? 0
                             : bit == 33 ? ~0u & ~ctrl_srst
                             : bit == 34 ? 0xAAAAAAAA & ~ctrl_srst
                                         : 0x55555555;
      bench.write(entry.offset, value);
      bench.drain();
      const uint32_t low = entry.offset & ~4u;
      bench.read(low | 4);
      bench.read(low);
      bench.read(entry.offset);
    }
    read_all(bench);
  }
  // Reset undoes all of it, whichever.
  for (bool pin : {true, false}) {
    for (const auto& entry : description::table)
      if (entry.offset != reg_ctrl && entry.offset != reg_cmd)
        bench.write(entry.offset, random.word32() & INT32_MAX);
    bench.write(reg_ctrl, 0x71F);
    bench.drain();
    if (pin)
      bench.pin_reset();
    else
      bench.write(reg_ctrl, ctrl_srst | 0x71F);
    read_all(bench);
  }
  // What is not there, everywhere in the block; and between the words.
  for (uint32_t offset = 0; offset < block_end; offset += 4) {
    const bool there = register_index(offset) < std::size(description::table);
    if (there || bench.failed()) continue;
    bench.read(offset);
    bench.write(offset, random.word32());
  }
  for (uint32_t offset = 0; offset <= reg_last + 4; ++offset) {
    if (offset % 4 == 0 || bench.failed()) continue;
    bench.write(offset, random.word32());
    bench.read(offset);
  }
  read_all(bench);
}

void run_pairs(Bench& bench, Random& random, const Budget&) {
  clean(bench);
  bench.write(reg_ctrl, ctrl_adc | ctrl_demod | ctrl_calib);
  std::vector<uint32_t> lows = {reg_freq_lo, reg_phase_lo};
  for (uint32_t offset = reg_au_lo; offset < reg_cv_hi; offset += 8) lows.push_back(offset);
  for (unsigned i = 0; i < 600 && !bench.failed(); ++i) {
    const uint32_t low = lows[random.below(lows.size())];
    switch (random.below(7)) {
      case 0:
        bench.write(low, corner32(random));
        break;
      case 1:
        bench.write(low + 4, corner32(random));
        break;
      case 2:
        bench.write(low, corner32(random));
        bench.write(lows[random.below(lows.size())] + 4, corner32(random));
        bench.write(low + 4, corner32(random));
        break;
      case 3:
        bench.read(low + 4);
        bench.sample(random.word32(), random.word32());
        bench.drain();
        bench.read(low);
        break;
      case 4:
        bench.read(low + 4, true);
        bench.read(low);
        bench.read(low, true);
        break;
      case 5:
        bench.read(low);
        bench.read(low + 4);
        bench.read(low);
        break;
      default:
        bench.sample(random.word32(), random.word32());
        bench.wait(random.below(bench.scaled(200)));
    }
    if (i % 100 == 99) {
      bench.write(reg_ctrl, ctrl_srst);
      bench.write(reg_ctrl, ctrl_adc | ctrl_demod | ctrl_calib);
      bench.read(low);
    }
  }
  // Words at the ends of Q2.46 and beyond what HI and LO can show.
  for (uint32_t low : lows)
    for (uint32_t high_word : {0x7FFFFFFFu, 0x80000000u, 0u, ~0u})
      for (uint32_t low_word : {0x7FFFFFFFu, 0x80000000u, 0x4000u, 0x3FFFu, 0xFFFFC000u, ~0u}) {
        bench.write(low, low_word);
        bench.write(low + 4, high_word);
        bench.read(low + 4);
        bench.read(low);
      }
}

void run_flags(Bench& bench, Random& random, const Budget&) {
  const uint32_t enables = ctrl_ie_result | ctrl_ie_lock | ctrl_ie_error;
  for (uint32_t enabled : {0u, ctrl_ie_result, ctrl_ie_lock, ctrl_ie_error, enables}) {
    if (bench.failed()) return;
    clean(bench);
    bench.write(reg_ctrl, ctrl_adc | ctrl_calib | ctrl_demod | enabled);
    bench.write(reg_judge, 0);  // LOCK by the average alone
    bench.interrupt();
    for (unsigned i = 0; i < 130 && !bench.failed(); ++i) {
      // Zero, clipped, saturated, mirrored and small ones in turn; lock is lost and regained.
      const uint32_t word = i % 7 == 0 ? 0 : i % 11 == 0 ? 0x80000000u : corner32(random);
      if (i % 13 == 0) bench.write_pair(0x50, (i % 2 == 0 ? 1 : -1) * (int64_t{1} << 45));
      if (i % 9 == 0) bench.write(reg_lock_threshold, i % 2 == 0 ? 0 : ~0u);
      if (i % 9 == 1) bench.write(reg_diverge_threshold, i % 2 == 0 ? 0 : ~0u);
      bench.drain();
      bench.wait(2);
      bench.sample(word, i % 7 == 0 ? 0 : random.word32(), i % 5 == 0);
      const uint64_t latched = bench.edge();
      bench.interrupt();
      if (i % 4 == 0) bench.sample(1, 2);
      if (i % 17 == 0) bench.sample(1, 2);
      if (i % 6 == 0) bench.write(reg_step_au, 1u << 31);
      if (i % 6 == 1) bench.write(reg_ctrl, ctrl_adc | ctrl_calib | ctrl_demod | enabled | 0xC);
      if (i % 6 == 2) bench.write(reg_a1, ~0u);
      // Some clear at the very edge of the commit, some next to it.
      bench.wait_until(latched + bench.latency() - 1);
      bench.interrupt();
      bench.wait_until(latched + bench.latency() + (i % 3 == 0 ? 0 : i % 3 - 1));
      if (i % 3 == 2) bench.interrupt();
      bench.write(reg_flags, i % 2 == 0 ? flags_all : 1u << random.below(flag_count));
      bench.interrupt();
      bench.read(reg_flags);
      bench.wait(1);
      bench.interrupt();
      if (i % 8 == 7) bench.write(reg_flags, flags_all);
      bench.interrupt();
      bench.read(reg_status);
    }
    // Enables decide at once.
    for (uint32_t other : {enables, 0u, ctrl_ie_error, ctrl_ie_lock, ctrl_ie_result}) {
      bench.write(reg_ctrl, other);
      bench.interrupt();
    }
  }
}

}  // namespace capsoc::regress
