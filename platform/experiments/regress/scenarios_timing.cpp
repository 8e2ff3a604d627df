// Directed sequences for the sequencer: everything at every edge of a sample's way.
#include "coprocessor/register_map.h"
#include "regress/scenario.h"

namespace capsoc::regress {

using namespace coprocessor;

namespace {

constexpr uint32_t running = ctrl_adc | ctrl_demod | ctrl_calib | ctrl_ie_result;

void start_again(Bench& bench, uint32_t ctrl = running) {
  bench.drain();
  bench.wait(3);
  bench.write(reg_ctrl, ctrl_srst);
  bench.write(reg_ctrl, ctrl);
}

void look(Bench& bench) {
  bench.interrupt();
  bench.read(reg_status);
  bench.read(reg_samples);
  bench.read(reg_early_count);
  bench.read(reg_angle);
}

void noise(Bench& bench, Random& random) {
  bench.sample(random.word32(), random.word32(), random.chance(0.1));
}

void parameters(Bench& bench, Random& random) {
  for (uint32_t offset = reg_a1; offset <= reg_phi; offset += 4)
    bench.write(offset, offset <= reg_a2 ? random.word32() & INT32_MAX : random.word32());
}

void read_weights(Bench& bench) {
  for (uint32_t offset = reg_au_lo; offset <= reg_cv_hi; offset += 8) {
    bench.read(offset + 4);
    bench.read(offset);
  }
}

}  // namespace

void run_spacing(Bench& bench, Random& random, const Budget&) {
  start_again(bench);
  bench.write_pair(reg_freq_lo, int64_t{1} << 42);
  for (uint64_t space = 1; space <= bench.scaled(200) && !bench.failed(); ++space) {
    for (unsigned i = 0; i < 7; ++i) {
      noise(bench, random);
      bench.wait(space);
    }
    look(bench);
    bench.drain();
    bench.wait(random.below(4));
    bench.read(reg_status);
  }
  for (unsigned i = 0; i < 300; ++i) {
    noise(bench, random);
    bench.wait(random.between(1, bench.scaled(230)));
  }
  bench.drain();
  look(bench);
}

void run_load_moments(Bench& bench, Random& random, const Budget&) {
  // LOAD at every edge after a lone sample; after it a sample that has to wait.
  for (uint64_t at = 0; at <= bench.latency() + 3 && !bench.failed(); ++at) {
    start_again(bench, at % 2 == 0 ? running : running & ~ctrl_demod);
    parameters(bench, random);
    bench.wait(2);
    noise(bench, random);
    bench.wait(at);
    bench.write(reg_cmd, cmd_load);
    bench.wait(random.below(bench.scaled(40)));
    noise(bench, random);
    bench.drain();
    look(bench);
    read_weights(bench);
  }
  // With a stream around it, a LOAD in a LOAD, writes in the middle of it.
  for (unsigned i = 0; i < 40 && !bench.failed(); ++i) {
    start_again(bench);
    parameters(bench, random);
    for (unsigned j = 0; j < 6; ++j) {
      noise(bench, random);
      bench.wait(random.between(bench.scaled(28), bench.scaled(36)));
    }
    bench.write(reg_cmd, cmd_load);
    bench.wait(random.below(bench.scaled(300)));
    if (i % 2 == 0) bench.write(reg_cmd, cmd_load);
    if (i % 3 == 0) parameters(bench, random);
    if (i % 5 == 0) bench.write_pair(reg_au_lo + 8 * static_cast<uint32_t>(random.below(6)), 12345);
    for (unsigned j = 0; j < 6; ++j) {
      noise(bench, random);
      bench.wait(random.between(1, bench.scaled(40)));
    }
    bench.drain();
    look(bench);
    read_weights(bench);
  }
  // From idle, the angles of Eq (8) all round, at the ends of the other parameters.
  for (unsigned i = 0; i < 128 && !bench.failed(); ++i) {
    start_again(bench);
    const uint32_t end = i % 2 == 0 ? INT32_MAX : 0;
    bench.write(reg_a1, i % 4 < 2 ? end : random.word32() & INT32_MAX);
    bench.write(reg_a2, i % 4 < 2 ? end : random.word32() & INT32_MAX);
    // Products that end in exactly one half, if the sine is odd.
    if (i % 4 == 3) bench.write(reg_a1, static_cast<uint32_t>(2 * random.below(100) + 1) << 15);
    if (i % 4 == 3) bench.write(reg_a2, static_cast<uint32_t>(2 * random.below(100) + 1) << 15);
    bench.write(reg_b1, corner32(random));
    bench.write(reg_b2, corner32(random));
    bench.write(reg_phi, (i << 28) + static_cast<uint32_t>(i % 3) - 1u);
    bench.write(reg_beta, i % 8 == 0 ? corner32(random) : i << 26);
    bench.write(reg_cmd, cmd_load);
    bench.drain();
    read_weights(bench);
    noise(bench, random);
    bench.drain();
    look(bench);
  }
}

void run_reset_moments(Bench& bench, Random& random, const Budget&) {
  for (int kind = 0; kind < 4; ++kind)
    for (uint64_t at = 0; at <= bench.latency() + 3 && !bench.failed(); ++at) {
      start_again(bench);
      if (kind >= 2) {
        // The pipeline full, a sample held.
        for (unsigned i = 0; i < 6; ++i) {
          noise(bench, random);
          bench.wait(i == 4 ? 5 : bench.tick());
        }
      } else {
        noise(bench, random);
      }
      bench.wait(at);
      const bool with_sample = random.chance(0.3);
      if (with_sample) noise(bench, random);
      if (kind % 2 == 0)
        bench.write(reg_ctrl, ctrl_srst | random.word32());
      else
        bench.pin_reset();
      look(bench);
      bench.read(reg_flags);
      bench.write(reg_ctrl, running);
      noise(bench, random);
      bench.wait(random.below(bench.scaled(60)));
      noise(bench, random);
      bench.drain();
      look(bench);
      read_weights(bench);
    }
  // In the course of a LOAD.
  for (uint64_t at = 0; at <= bench.scaled(100) && !bench.failed(); ++at) {
    start_again(bench);
    bench.write(reg_cmd, cmd_load);
    bench.wait(at);
    if (at % 3 == 0) noise(bench, random);
    if (at % 2 == 0)
      bench.write(reg_ctrl, ctrl_srst);
    else
      bench.pin_reset();
    bench.wait(random.below(bench.scaled(40)));
    bench.write(reg_ctrl, running);
    noise(bench, random);
    bench.drain();
    look(bench);
    read_weights(bench);
  }
  // A LOAD that waits.
  for (bool soft : {true, false})
    for (unsigned i = 0; i < 8; ++i) {
      start_again(bench);
      noise(bench, random);
      bench.wait(random.between(3, bench.scaled(100)));
      bench.write(reg_cmd, cmd_load);
      bench.wait(random.between(1, 20));
      if (soft)
        bench.write(reg_ctrl, ctrl_srst);
      else
        bench.pin_reset();
      bench.wait(bench.scaled(200));
      look(bench);
      read_weights(bench);
      // An idle one, right after the latching edge.
      bench.write(reg_ctrl, running);
      noise(bench, random);
      if (soft)
        bench.write(reg_ctrl, ctrl_srst);
      else
        bench.pin_reset();
      bench.wait(bench.scaled(40));
      look(bench);
    }
}

void run_collisions(Bench& bench, Random& random, const Budget&) {
  // Every register that something may write, at every tick boundary of a sample's way and one edge
  // next to it.
  for (unsigned source = 0; source < 3; ++source)
    for (uint32_t offset = reg_ctrl; offset <= reg_soft_v; offset += 4)
      for (uint64_t tick = 0; tick <= 5; ++tick) {
        if (offset == reg_status || bench.failed()) continue;
        const uint64_t beside =
            random.below(3);  // mostly: the edge itself, in every scenario's run
        for (uint64_t at : {uint64_t{1}, beside}) {
          const uint32_t ctrl = running | source << ctrl_ref_shift;
          start_again(bench, ctrl);
          bench.wait(2);
          noise(bench, random);
          const uint64_t latched = bench.edge();
          bench.wait_until(latched + bench.tick() * tick + at);
          uint32_t value = random.word32();
          if (offset == reg_ctrl) value = (value & 0x70F) | ctrl_adc;
          if (offset >= reg_step_au && offset <= reg_step_cv) value &= INT32_MAX;
          if (offset == reg_a1 || offset == reg_a2) value &= INT32_MAX;
          if (offset == reg_flags) value |= flag_result;
          bench.write(offset, value);
          bench.interrupt();
          bench.wait(1);
          noise(bench, random);
          bench.drain();
          look(bench);
          bench.read(reg_flags);
          bench.read(offset | 4);
          bench.read(offset);
          bench.read(reg_phase_hi);
          bench.read(reg_freq_hi);
        }
      }
  // Soft reset together with a commit, an early sample together with CLEAR and with W1C.
  for (unsigned i = 0; i < 12 && !bench.failed(); ++i) {
    start_again(bench);
    noise(bench, random);
    bench.wait(i < 4 ? bench.latency() : 4);
    if (i >= 4) noise(bench, random);
    if (i >= 4) bench.wait(1);
    noise(bench, random);
    if (i < 4) bench.write(reg_ctrl, ctrl_srst);
    if (i >= 4 && i < 8) bench.write(reg_flags, flags_all);
    if (i >= 8) bench.write(reg_cmd, cmd_clear | cmd_phase0);
    look(bench);
    bench.read(reg_flags);
    bench.drain();
    look(bench);
  }
}

void run_modes(Bench& bench, Random& random, const Budget&) {
  // 12 modes, from each to each, at a tick of a lone sample's way that differs from pair to pair.
  const auto ctrl = [](unsigned mode) {
    return ctrl_adc | (mode % 4) | (mode / 4) << ctrl_ref_shift;
  };
  start_again(bench);
  bench.write_pair(reg_freq_lo, int64_t{1} << 43);
  for (unsigned from = 0; from < 12; ++from)
    for (unsigned to = 0; to < 12 && !bench.failed(); ++to)
      for (bool busy : {false, true}) {
        bench.drain();
        bench.wait(2);
        bench.write(reg_ctrl, ctrl(from));
        noise(bench, random);
        if (busy)
          bench.wait(random.below(bench.latency()));
        else
          bench.drain();
        bench.write(reg_ctrl, ctrl(to));
        noise(bench, random);
        bench.wait(random.below(bench.latency() + bench.tick()));
        look(bench);
        read_weights(bench);
        bench.read(reg_freq_hi);
        bench.read(reg_phase_hi);
        bench.read(reg_a1);
      }
}

void run_overruns(Bench& bench, Random& random, const Budget&) {
  start_again(bench);
  for (uint64_t burst = 2; burst < 40 && !bench.failed(); ++burst) {
    for (uint64_t i = 0; i < burst; ++i) noise(bench, random);
    look(bench);
    bench.read(reg_flags);
    bench.write(reg_flags, flag_early);
    if (burst % 8 == 0) bench.drain();
    if (burst % 5 == 0) bench.write(reg_cmd, cmd_clear);
    bench.wait(random.below(20));
  }
  // Software and the stream compete; the stream is switched off in the middle.
  for (unsigned i = 0; i < 60 && !bench.failed(); ++i) {
    bench.soft_sample(random.word32(), random.word32());
    bench.wait(random.below(30));
    noise(bench, random);
    bench.write(reg_soft_v, random.word32());
    if (i % 7 == 0) bench.write(reg_ctrl, (i % 2 == 0 ? ctrl_adc : 0) | ctrl_calib);
    look(bench);
  }
  // Both at one edge: the stream comes first.
  for (unsigned i = 0; i < 40 && !bench.failed(); ++i) {
    bench.drain();
    bench.write(reg_ctrl, ctrl_calib | ctrl_adc);
    bench.wait(2);
    noise(bench, random);
    bench.write(reg_soft_v, random.word32());
    bench.wait(i);
    noise(bench, random);
    bench.write(reg_soft_v, random.word32());
    look(bench);
    bench.drain();
    look(bench);
  }
}

}  // namespace capsoc::regress
