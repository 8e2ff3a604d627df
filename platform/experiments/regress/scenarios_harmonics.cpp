// The harmonic correction: every node and both ends of its word, any fraction, the moments of a
// node's write and of CTRL.CORRECT, and what a reset leaves.
#include <array>

#include "coprocessor/harmonic_correction.h"
#include "coprocessor/register_map.h"
#include "coprocessor/sequencer.h"
#include "regress/scenario.h"
#include "regress/shaft.h"

namespace capsoc::regress {

using namespace coprocessor;

namespace {

constexpr uint32_t correcting = ctrl_calib | ctrl_correct;
constexpr uint32_t largest = correction_value_mask >> 1, smallest = largest + 1;

void write_node(Bench& bench, unsigned node, uint32_t value) {
  bench.write(reg_correction,
              node << description::CORRECTION_NODE_shift | (value & correction_value_mask));
}

// Jumps between the ends of the word, slopes of all sizes, and zeros.
uint32_t any_value(Random& random) {
  const uint32_t word = random.word32();
  switch (word & 7) {
    case 0:
      return largest;
    case 1:
      return smallest;
    case 2:
      return 0;
    default:
      return random.word32() >> (word >> 27);
  }
}

void write_table(Bench& bench, Random& random) {
  bench.drain();
  for (unsigned node = 0; node < correction_nodes; ++node)
    write_node(bench, node, any_value(random));
}

void read_results(Bench& bench) {
  for (uint32_t offset :
       {reg_angle, reg_residue, reg_ref_phase, reg_status, reg_flags, reg_ctrl, reg_correction})
    bench.read(offset);
  bench.write(reg_flags, flags_all);
}

// Writes nodes `distance` edges after a sample: while the sample waits, in each stage, at the edge
// of its commit and after it.
void write_beside_a_sample(Bench& bench, Random& random, unsigned distance) {
  bench.drain();
  bench.sample(random.word32(), random.word32());
  bench.wait(distance);
  for (unsigned i = 0; i < 3; ++i)
    write_node(bench, random.word32() % correction_nodes, any_value(random));
  bench.drain();
  read_results(bench);
  bench.sample(random.word32(), random.word32());
  bench.drain();
  read_results(bench);
}

}  // namespace

void run_corrections(Bench& bench, Random& random, const Budget&) {
  for (uint32_t source : {0u, 1u, 2u})
    for (uint32_t learning : {0u, ctrl_demod, ctrl_demod | ctrl_block}) {
      if (bench.failed()) return;
      Shaft shaft(bench, correcting | learning | source << ctrl_ref_shift, 0.0127);
      bench.write(reg_ctrl, correcting | learning | source << ctrl_ref_shift);
      write_table(bench, random);
      bench.write(reg_ctrl, ctrl_adc | correcting | learning | source << ctrl_ref_shift);
      bench.write(reg_phi, random.word32());
      shaft.move(100, 0.0127, 1.02);
      bench.drain();
      read_results(bench);
    }
}

void run_correction_nodes(Bench& bench, Random& random, const Budget&) {
  // Position by PHI: the angle against the reference keeps still.
  Shaft shaft(bench, correcting, 0);
  bench.write(reg_ctrl, correcting);
  write_table(bench, random);
  bench.write(reg_ctrl, ctrl_adc | correcting);
  for (uint32_t node = 0; node < correction_nodes && !bench.failed(); ++node) {
    const std::array<uint32_t, 4> fractions = {0, 0x1FFFFFF, 1u << (random.word32() % 25),
                                               random.word32() & 0x1FFFFFF};
    for (uint32_t fraction : fractions) {
      bench.write(reg_phi, (node << 25) + fraction);
      shaft.move(1, 0);
      bench.drain();
      bench.read(reg_angle);
      bench.read(reg_residue);
    }
  }
}

void run_correction_moments(Bench& bench, Random& random, const Budget&) {
  bench.write(reg_ctrl, ctrl_adc | correcting | ctrl_ie_error);
  for (unsigned distance = 0; distance < 8 && !bench.failed(); ++distance)
    write_beside_a_sample(bench, random, distance);
  for (unsigned distance = 30; distance < 70 && !bench.failed(); ++distance)
    write_beside_a_sample(bench, random, distance);
  for (unsigned distance = latency_cycles - 8; distance < latency_cycles + 4; ++distance)
    if (!bench.failed()) write_beside_a_sample(bench, random, distance);
  // CORRECT and PHI in every cycle of T1.
  for (unsigned distance = 28; distance < 70 && !bench.failed(); ++distance) {
    bench.drain();
    bench.sample(random.word32(), random.word32());
    bench.wait(distance);
    bench.write((distance & 1) != 0 ? reg_phi : reg_ctrl,
                (distance & 1) != 0 ? random.word32()
                                    : ctrl_adc | ctrl_calib | (distance & 2 ? ctrl_correct : 0));
    bench.drain();
    read_results(bench);
    bench.write(reg_ctrl, ctrl_adc | correcting);
  }
  // A LOAD is busy as well; a reset leaves the nodes.
  write_table(bench, random);
  bench.write(reg_cmd, cmd_load);
  write_node(bench, 0, largest);
  bench.drain();
  read_results(bench);
  for (int pin : {0, 1}) {
    if (pin != 0)
      bench.pin_reset();
    else
      bench.write(reg_ctrl, ctrl_srst);
    bench.write(reg_ctrl, ctrl_adc | correcting);
    for (int i = 0; i < 16 && !bench.failed(); ++i) {
      bench.sample(random.word32(), random.word32());
      bench.drain();
      read_results(bench);
    }
  }
}

}  // namespace capsoc::regress
