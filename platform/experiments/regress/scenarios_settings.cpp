// Settings that hold for one tick alone: each stage reads its own, at its tick's first edge.
#include <vector>

#include "coprocessor/register_map.h"
#include "regress/scenario.h"

namespace capsoc::regress {

using namespace coprocessor;

namespace {

constexpr uint32_t learning = ctrl_adc | ctrl_demod | ctrl_calib;
struct Momentary {
  uint32_t offset, before, during;
};

std::vector<Momentary> momentary_settings() {
  std::vector<Momentary> result = {
      {reg_ctrl, learning, learning & ~ctrl_demod},
      {reg_ctrl, learning & ~ctrl_demod, learning},
      {reg_ctrl, learning, learning & ~ctrl_calib},
      {reg_ctrl, learning & ~ctrl_calib, learning},
      {reg_ctrl, learning, learning & ~ctrl_adc},
      {reg_lock_threshold, ~0u, 0},
      {reg_diverge_threshold, ~0u, 0},
      {reg_judge, 0, 1u << 19},  // SLEW
      {reg_judge, 0, 1},         // RADIUS_LIMIT
      {reg_judge, 0, 1u << 8},   // ALARM_LIMIT
      {reg_judge, 0, 1u << 16},  // TURNS
      {reg_judge, 0, 1u << 18},  // COUNT
      {reg_turn_limit, 0, 1},
      {reg_loop, 0x0A04, 0x0101},
      {reg_step_au, 1u << 28, 1u << 20},
      {reg_phi, 1u << 29, 1u << 20},
      {reg_a1, 1u << 30, 1u << 20},
  };
  for (uint32_t from = 0; from < 3; ++from)
    for (uint32_t to = 0; to < 3; ++to)
      if (from != to)
        result.push_back(
            {reg_ctrl, learning | from << ctrl_ref_shift, learning | to << ctrl_ref_shift});
  return result;
}

void begin_again(Bench& bench, uint32_t ctrl) {
  bench.drain();
  bench.wait(3);
  bench.write(reg_ctrl, ctrl_srst);
  bench.write(reg_ctrl, ctrl);
  bench.write(reg_judge, 0);
  for (uint32_t offset = reg_step_au; offset <= reg_step_cv; offset += 4)
    bench.write(offset, 1u << 28);
  bench.write_pair(reg_freq_lo, int64_t{3} << 44);
  bench.write_pair(reg_phase_lo,
                   (int64_t{1} << 48) - (int64_t{1} << 44));  // the reference ends a turn
}

}  // namespace

void run_settings(Bench& bench, Random& random, const Budget&) {
  for (const Momentary& setting : momentary_settings())
    for (bool zero : {false, true})
      for (uint64_t stage = 0; stage < 5 && !bench.failed(); ++stage) {
        // LOCK needs 64 samples; the others of a run need none.
        const bool locks = setting.offset == reg_lock_threshold ||
                           setting.offset == reg_diverge_threshold || setting.during == 1u << 16;
        if (zero && locks) continue;
        begin_again(bench, setting.offset == reg_ctrl ? setting.before : learning);
        bench.write(setting.offset, setting.before);
        if (locks) bench.write(reg_lock_threshold, ~0u);
        for (unsigned i = 0; locks && i < 70; ++i) {
          bench.sample(random.word32(), random.word32());
          bench.wait(bench.tick());
        }
        bench.drain();
        bench.wait(2);
        const uint64_t latched = bench.edge();
        bench.sample(zero ? 0 : random.word32() >> 2, zero ? 0 : random.word32() >> 2);
        // Seen by the start of one tick and gone before the next.
        bench.wait_until(latched + bench.tick() * stage);
        bench.write(setting.offset, setting.during);
        bench.wait_until(latched + bench.tick() * stage + 2);
        bench.write(setting.offset, setting.before);
        bench.drain();
        bench.read(reg_status);
        bench.sample(random.word32() >> 2, random.word32() >> 2);
        bench.drain();
        bench.read(reg_flags);
      }
}

}  // namespace capsoc::regress
