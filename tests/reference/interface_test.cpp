// libcapsoc_reference.so against the model by its C++ interface, and its errors.
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <string>

#include "capsoc_reference.h"
#include "coprocessor/coprocessor.h"
#include "coprocessor/register_map.h"

namespace capsoc::reference_test {
namespace {

using namespace coprocessor;

constexpr int ok = CAPSOC_REFERENCE_OK, argument = CAPSOC_REFERENCE_ARGUMENT,
              order = CAPSOC_REFERENCE_ORDER;

class Reference : public ::testing::Test {
 protected:
  ~Reference() override { capsoc_reference_destroy(reference); }

  std::string error() const { return capsoc_reference_error(reference); }

  uint32_t peek(uint32_t address) const {
    uint32_t data = 0;
    EXPECT_EQ(capsoc_reference_peek(reference, address, &data), ok);
    return data;
  }

  // A write with its edge.
  void write(uint32_t address, uint32_t data) {
    uint32_t slverr = 1;
    EXPECT_EQ(capsoc_reference_write(reference, address, data, 15, &slverr), ok);
    EXPECT_EQ(slverr, 0u);
    EXPECT_EQ(capsoc_reference_clock(reference, 1), ok);
  }

  capsoc_reference* reference = capsoc_reference_create(0, 32, 0, 0, 0, 1, 1, 1, 1);
};

// Both have the same traffic; what acts at an edge is named by it in C++, by its interval in C.
void compare(capsoc_reference* reference, Coprocessor& model, uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto below = [&](uint32_t bound) { return static_cast<uint32_t>(random() % bound); };
  uint64_t edge = 0;
  for (int i = 0; i < 20'000 && !::testing::Test::HasFailure(); ++i) {
    uint32_t ready = 2, irq = 2, idle = 2, outputs_ready = 2;
    ASSERT_EQ(capsoc_reference_outputs(reference, &outputs_ready, &irq, &idle), ok);
    EXPECT_EQ(irq, model.interrupt());
    EXPECT_EQ(idle, model.idle());
    const bool sample = below(64) == 0, write = below(4) == 0, read = !write && below(4) == 0;
    const auto u = static_cast<int32_t>(random()), v = static_cast<int32_t>(random());
    const uint32_t address = below(16) == 0 ? below(0x1000) : 4 * below(64);
    const uint32_t data = address == reg_ctrl ? ctrl_adc | ctrl_calib | ctrl_demod | ctrl_ie_result
                                              : static_cast<uint32_t>(random()) >> below(32);
    const auto strobes = static_cast<uint8_t>(below(16) == 0 ? below(16) : 15);
    uint32_t word = 0, slverr = 2;
    // The library is called in both orders.
    const bool sample_first = below(2) == 0;
    if (sample && sample_first) {
      EXPECT_EQ(capsoc_reference_sample(reference, u, v, i & 1, &ready), ok);
    }
    if (write) {
      EXPECT_EQ(capsoc_reference_write(reference, address, data, strobes, &slverr), ok);
    }
    if (read) {
      EXPECT_EQ(capsoc_reference_read(reference, address, &word, &slverr), ok);
      const RegisterAccess access = model.read(edge, address, false);
      EXPECT_EQ(slverr, access.ok ? 0 : 1);
      EXPECT_EQ(word, access.value);
    }
    if (sample && !sample_first) {
      EXPECT_EQ(capsoc_reference_sample(reference, u, v, i & 1, &ready), ok);
    }
    const uint32_t edges = below(8) == 0 ? 1 + below(40) : 1;
    EXPECT_EQ(capsoc_reference_clock(reference, edges), ok);
    if (sample) {
      EXPECT_EQ(ready, model.submit(edge + 1, u, v, (i & 1) != 0));
      EXPECT_EQ(ready, outputs_ready);
    }
    if (write) {
      EXPECT_EQ(slverr, model.write_bytes(edge + 1, address, data, strobes) ? 0 : 1);
    }
    edge += edges;
    model.advance(edge);
    EXPECT_EQ(capsoc_reference_edge(reference), edge);
    EXPECT_EQ(capsoc_reference_commits(reference), model.nodes().commits);
  }
  EXPECT_GT(model.nodes().commits, 50u);
  for (uint32_t address = 0; address < 0x110; address += 4) {
    uint32_t data = 1;
    EXPECT_EQ(capsoc_reference_peek(reference, address, &data), ok);
    EXPECT_EQ(data, model.read(edge, address, true).value) << address;
  }
  for (int32_t index = 0; index < capsoc_reference_signal_count(); ++index) {
    const NamedNode& node = node_names().at(static_cast<std::size_t>(index));
    int64_t value = 0;
    int32_t bits = 0, is_signed = 0, fraction = 0, stage = 0;
    EXPECT_EQ(capsoc_reference_signal(reference, index, &value), ok);
    EXPECT_EQ(value, model.nodes().*node.value) << node.name;
    EXPECT_EQ(capsoc_reference_signal_format(index, &bits, &is_signed, &fraction, &stage), ok);
    EXPECT_EQ(bits, static_cast<int32_t>(node.format.width));
    EXPECT_EQ(is_signed != 0, node.format.is_signed);
    EXPECT_EQ(fraction, static_cast<int32_t>(node.format.fraction));
    EXPECT_EQ(stage, static_cast<int32_t>(node.stage));
    EXPECT_STREQ(capsoc_reference_signal_name(index), node.name);
    EXPECT_EQ(capsoc_reference_signal_index(node.name), index);
  }
}

TEST_F(Reference, RandomTrafficIsThatOfTheModel) {
  Coprocessor model({});
  compare(reference, model, 1);
}

TEST(ReferencePaper, RandomTrafficIsThatOfTheModel) {
  Options options;
  options.arithmetic = Arithmetic::paper;
  options.paper_operand_bits = 16;
  options.paper_reference_lead = 2;
  options.paper_step_shift = 7;
  options.paper_plain_arctangent = true;
  options.paper_iteration_clocks = 2;
  options.safety = false;
  Coprocessor model(options);
  capsoc_reference* reference = capsoc_reference_create(1, 16, 2, 7, 1, 2, 1, 1, 0);
  ASSERT_NE(reference, nullptr);
  compare(reference, model, 2);
  capsoc_reference_destroy(reference);
}

TEST_F(Reference, ASampleIsCommitted161EdgesAfterItsOwn) {
  write(reg_ctrl, ctrl_adc | ctrl_ie_result);
  uint32_t ready = 0, irq = 0, idle = 0;
  EXPECT_EQ(capsoc_reference_sample(reference, 1 << 30, 0, 0, &ready), ok);
  EXPECT_EQ(ready, 1u);
  EXPECT_EQ(capsoc_reference_clock(reference, 1 + 160), ok);
  EXPECT_EQ(capsoc_reference_outputs(reference, &ready, &irq, &idle), ok);
  EXPECT_EQ(irq, 0u);
  EXPECT_EQ(capsoc_reference_clock(reference, 1), ok);
  EXPECT_EQ(capsoc_reference_outputs(reference, &ready, &irq, &idle), ok);
  EXPECT_EQ(irq, 1u);
  EXPECT_EQ(capsoc_reference_commits(reference), 1u);
  int64_t u = 0;
  EXPECT_EQ(capsoc_reference_signal(reference, capsoc_reference_signal_index("u"), &u), ok);
  EXPECT_EQ(u, 1 << 30);
}

TEST_F(Reference, ResetForgetsTheInterval) {
  write(reg_soft_u, 5);
  uint32_t slverr = 0, ready = 0;
  EXPECT_EQ(capsoc_reference_write(reference, reg_soft_u, 7, 15, &slverr), ok);
  EXPECT_EQ(capsoc_reference_sample(reference, 1, 2, 0, &ready), ok);
  EXPECT_EQ(capsoc_reference_reset(reference), ok);
  EXPECT_EQ(peek(reg_soft_u), 0u);
  EXPECT_EQ(capsoc_reference_clock(reference, 1), ok);
  EXPECT_EQ(peek(reg_soft_u), 0u);
  EXPECT_EQ(capsoc_reference_edge(reference), 2u);
}

TEST_F(Reference, AnIntervalHasOneAccessAndOneSample) {
  uint32_t data = 9, slverr = 9, ready = 9;
  EXPECT_EQ(capsoc_reference_read(reference, reg_id, &data, &slverr), ok);
  EXPECT_EQ(capsoc_reference_write(reference, reg_soft_u, 1, 15, &slverr), order);
  EXPECT_NE(error().find("write: the interval after edge 0 has an access already"),
            std::string::npos)
      << error();
  EXPECT_EQ(capsoc_reference_sample(reference, 0, 0, 0, &ready), ok);
  EXPECT_EQ(capsoc_reference_sample(reference, 0, 0, 0, &ready), order);
  EXPECT_EQ(capsoc_reference_clock(reference, 1), ok);
  EXPECT_EQ(peek(reg_soft_u), 0u);
  EXPECT_EQ(capsoc_reference_read(reference, reg_id, &data, &slverr), ok);
}

TEST_F(Reference, WrongArgumentsAreSentencesAndChangeNothing) {
  uint32_t word = 9, other = 9;
  int64_t value = 9;
  EXPECT_EQ(capsoc_reference_read(reference, 0x1000, &word, &other), argument);
  EXPECT_EQ(error(), "capsoc_reference_read: address is 4096; it must be 0 to 4095");
  EXPECT_EQ(word, 9u);
  EXPECT_EQ(capsoc_reference_write(reference, 0, 0, 16, &word), argument);
  EXPECT_EQ(error(), "capsoc_reference_write: strobes is 16; it must be 0 to 15");
  EXPECT_EQ(capsoc_reference_sample(reference, 0, 0, 2, &word), argument);
  EXPECT_EQ(capsoc_reference_clock(reference, 0), argument);
  EXPECT_EQ(error(), "capsoc_reference_clock: edges is 0; it must be 1 to 4294967295");
  EXPECT_EQ(capsoc_reference_read(reference, 0, nullptr, &word), argument);
  EXPECT_EQ(capsoc_reference_signal(reference, -1, &value), argument);
  EXPECT_EQ(capsoc_reference_signal(reference, capsoc_reference_signal_count(), &value), argument);
  EXPECT_EQ(value, 9);
  EXPECT_EQ(capsoc_reference_signal_index("no_such_signal"), -1);
  EXPECT_EQ(capsoc_reference_signal_name(-1), nullptr);
  // None of them has begun an access.
  EXPECT_EQ(capsoc_reference_read(reference, 0, &word, &other), ok);
}

TEST_F(Reference, NullIsRefused) {
  uint32_t word = 0;
  EXPECT_EQ(capsoc_reference_clock(nullptr, 1), argument);
  EXPECT_STREQ(capsoc_reference_error(nullptr), "capsoc_reference_clock: a pointer is null");
  EXPECT_EQ(capsoc_reference_reset(nullptr), argument);
  EXPECT_EQ(capsoc_reference_read(nullptr, 0, &word, &word), argument);
  EXPECT_EQ(capsoc_reference_write(nullptr, 0, 0, 15, &word), argument);
  EXPECT_EQ(capsoc_reference_peek(nullptr, 0, &word), argument);
  EXPECT_EQ(capsoc_reference_sample(nullptr, 0, 0, 0, &word), argument);
  EXPECT_EQ(capsoc_reference_outputs(nullptr, &word, &word, &word), argument);
  EXPECT_EQ(capsoc_reference_edge(nullptr), 0u);
  EXPECT_EQ(capsoc_reference_commits(nullptr), 0u);
  EXPECT_EQ(capsoc_reference_signal_index(nullptr), -1);
  capsoc_reference_destroy(nullptr);
}

TEST(ReferenceParameters, OutsideTheirRangesThereIsNoReference) {
  struct Wrong {
    int paper, bits, lead, shift, plain, clocks, block, harmonics, safety;
    const char* said;
  };
  for (const Wrong& w :
       {Wrong{2, 32, 0, 0, 0, 1, 1, 1, 1, "paper is 2; it must be 0 to 1"},
        Wrong{0, 33, 0, 0, 0, 1, 1, 1, 1, "operand_bits is 33; it must be 2 to 32"},
        Wrong{0, 32, 1025, 0, 0, 1, 1, 1, 1, "reference_lead is 1025"},
        Wrong{0, 32, 0, -1, 0, 1, 1, 1, 1, "step_shift is -1"},
        Wrong{0, 32, 0, 0, 2, 1, 1, 1, 1, "plain_arctangent is 2"},
        Wrong{0, 32, 0, 0, 0, 3, 1, 1, 1, "iteration_clocks is 3"},
        Wrong{0, 32, 0, 0, 0, 1, -1, 1, 1, "block is -1"},
        Wrong{0, 32, 0, 0, 0, 1, 1, 7, 1, "harmonics is 7"},
        Wrong{0, 32, 0, 0, 0, 1, 1, 1, 2, "safety is 2; it must be 0 to 1"}}) {
    EXPECT_EQ(capsoc_reference_create(w.paper, w.bits, w.lead, w.shift, w.plain, w.clocks, w.block,
                                      w.harmonics, w.safety),
              nullptr);
    EXPECT_NE(std::string(capsoc_reference_error(nullptr)).find(w.said), std::string::npos)
        << capsoc_reference_error(nullptr);
  }
  EXPECT_EQ(capsoc_reference_version(), CAPSOC_REFERENCE_VERSION);
}

}  // namespace
}  // namespace capsoc::reference_test
