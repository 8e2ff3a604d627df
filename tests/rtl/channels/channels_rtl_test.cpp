// The RTL of several channels, Verilated, against the C++ model at its pins, interval by interval.
// docs/reference/coprocessor.md, "Channels".
#include <gtest/gtest.h>
#include <verilated.h>

#include <memory>
#include <random>

#include "../../coprocessor/several_channels.h"
#include "../../registers/likely_word.h"
#include "Vchannels_16.h"
#include "Vchannels_2.h"
#include "Vchannels_4.h"
#include "Vchannels_paper.h"
#include "coprocessor/channel_register.h"
#include "coprocessor/coprocessor.h"

// Verilator's library asks for it.
double sc_time_stamp() {
  return 0;
}

namespace capsoc::coprocessor {
namespace {

struct Stimulus {
  bool access = false, write = false;
  uint32_t address = 0, data = 0;
  bool sample = false, clip = false;
  unsigned channel = 0;
  int32_t u = 0, v = 0;
};

template <typename Rtl>
class Bench {
 public:
  Bench(const Options& options, int seed) : model_(options) {
    context_ = std::make_unique<VerilatedContext>();
    context_->randReset(2);
    context_->randSeed(seed);
    rtl_ = std::make_unique<Rtl>(context_.get());
    drive({});
    rtl_->presetn_i = 1;
    rtl_->eval();
    reset();
  }
  ~Bench() { rtl_->final(); }

  void reset() {
    rtl_->presetn_i = 0;
    rtl_->eval();
    rtl_->presetn_i = 1;
    rtl_->eval();
    model_.reset();
  }

  // An interval with these inputs, and the edge that ends it.
  void step(const Stimulus& s) {
    drive(s);
    rtl_->eval();
    expect("irq", rtl_->irq_o, model_.interrupt());
    expect("idle", rtl_->idle_o, model_.idle());
    bool mapped = true;
    if (s.access && !s.write) {
      const RegisterAccess read = model_.read(cycle_, s.address, false);
      mapped = read.ok;
      expect("prdata", rtl_->prdata_o, read.value);
    }
    const bool error = rtl_->pslverr_o, ready = rtl_->sample_ready_o;
    ++cycle_;
    if (s.sample)
      expect("sample_ready", ready, model_.submit_of(s.channel, cycle_, s.u, s.v, s.clip));
    else
      model_.advance(cycle_);
    if (s.access && s.write) mapped = model_.write(cycle_, s.address, s.data);
    expect("pslverr", error, s.access && !mapped);
    clock();
  }

  void write(uint32_t offset, uint32_t value) {
    Stimulus s;
    s.access = s.write = true;
    s.address = offset;
    s.data = value;
    step(s);
    step({});
  }

  // The nodes of the harmonic correction are anything at power-up.
  void clear_nodes() {
    for (unsigned each = 0; each < model_.channels(); ++each) {
      write(channel::offset, each | channel::hold);
      for (unsigned i = 0; i < 2 * change_cycles; ++i) step({});
      for (uint32_t node = 0; node < 128; ++node)
        write(reg_correction, node << correction_node_shift);
      write(reg_flags, ~0u);  // CONFIG, in paper
    }
  }

  // Every register as the window shows it, without a clock.
  void compare_registers() {
    for (uint32_t offset = 0; offset <= reg_last; offset += 4) {
      const auto* const rule = find_rule(offset);
      if (rule == nullptr || (rule->pair != registers::no_pair && !rule->high)) continue;
      Stimulus s;
      s.access = true;
      s.address = offset;
      drive(s);
      rtl_->eval();
      EXPECT_EQ(rtl_->prdata_o, model_.read(cycle_, offset, true).value)
          << std::hex << offset << " in interval " << std::dec << cycle_;
    }
    drive({});
    rtl_->eval();
  }

  Coprocessor& model() { return model_; }
  uint64_t cycle() const { return cycle_; }

 private:
  void expect(const char* what, uint64_t actual, uint64_t expected) {
    EXPECT_EQ(actual, expected) << what << " in interval " << cycle_ << std::hex << ", address "
                                << static_cast<unsigned>(rtl_->paddr_i);
  }

  void drive(const Stimulus& s) {
    rtl_->psel_i = rtl_->penable_i = s.access;
    rtl_->pwrite_i = s.write;
    rtl_->paddr_i = static_cast<uint16_t>(s.address);
    rtl_->pwdata_i = s.data;
    rtl_->pstrb_i = 0xF;
    rtl_->sample_valid_i = s.sample;
    rtl_->sample_u_i = static_cast<uint32_t>(s.u);
    rtl_->sample_v_i = static_cast<uint32_t>(s.v);
    rtl_->sample_clip_i = s.clip;
    rtl_->sample_channel_i = static_cast<uint8_t>(s.channel);
  }

  void clock() {
    rtl_->pclk_i = 1;
    rtl_->eval();
    rtl_->pclk_i = 0;
    rtl_->eval();
  }

  Coprocessor model_;
  std::unique_ptr<VerilatedContext> context_;
  std::unique_ptr<Rtl> rtl_;
  uint64_t cycle_ = 0;
};

// Stretches with few samples, with some of every channel, and with more than fit.
class Traffic {
 public:
  Traffic(unsigned count, uint64_t seed) : count_(count), random_(seed) {}

  Stimulus next(Coprocessor& model, uint64_t cycle) {
    if (cycle % 4000 == 0) {
      constexpr unsigned rates[] = {0, 2, 6, 30, 300};  // of 1000 intervals
      rate_ = rates[below(5)];
      quiet_ = below(3) == 0;
    }
    Stimulus s;
    s.sample = below(1000) < rate_;
    s.channel = below(below(50) == 0 ? 16 : count_);
    s.clip = below(8) == 0;
    s.u = static_cast<int32_t>(likely_word(random_)) >> below(4);
    s.v = static_cast<int32_t>(likely_word(random_)) >> below(4);
    if (cycle < busy_until_ || (quiet_ && below(100) != 0)) return s;
    busy_until_ = cycle + 2;
    s.access = below(4) != 0;
    s.write = below(2) == 0;
    s.address = below(0x40) * 4;
    s.data = likely_word(random_);
    if (below(64) == 0) s.address = below(0x1000);
    const bool ready = (model.read(cycle, channel::offset, true).value & channel::ready) != 0;
    if (below(ready ? 40 : 4) == 0) s.address = channel::offset;
    if (s.write && s.address == channel::offset) s.data = channel_data();
    if (s.write && s.address == reg_ctrl) {
      if (below(40) != 0) s.data &= ~ctrl_srst;
      if (below(8) != 0) s.data |= ctrl_adc | ctrl_calib;
    }
    return s;
  }

 private:
  unsigned below(unsigned n) { return static_cast<unsigned>(random_() % n); }
  uint32_t channel_data() {
    const uint32_t window = below(16) == 0 ? below(16) : below(count_);
    return window | (below(3) != 0 ? channel::hold : 0) | (below(2) != 0 ? channel::refused : 0) |
           (static_cast<uint32_t>(random_()) & 0xFFFF0000);
  }

  unsigned count_;
  std::mt19937_64 random_;
  unsigned rate_ = 0;
  bool quiet_ = false;
  uint64_t busy_until_ = 0;
};

template <typename Rtl>
void random_traffic(unsigned count, Arithmetic arithmetic, uint64_t seed, unsigned cycles) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  Bench<Rtl> bench(with_channels(count, arithmetic), static_cast<int>(seed));
  bench.clear_nodes();
  Traffic traffic(count, seed);
  uint64_t commits = 0;
  uint64_t results = 0, changes = 0;
  unsigned last = 0;
  while (bench.cycle() < cycles && !testing::Test::HasFailure()) {
    bench.step(traffic.next(bench.model(), bench.cycle()));
    const Nodes& nodes = bench.model().nodes();
    if (nodes.commits > commits) {
      ++results;
      if (nodes.channel != last) ++changes;
      last = nodes.channel;
      bench.compare_registers();
    }
    commits = nodes.commits;
    if (bench.cycle() % 60000 == 0) bench.reset();
  }
  bench.compare_registers();
  EXPECT_GT(results, cycles / 2000);
  EXPECT_GT(changes, cycles / 8000);
}

TEST(ChannelsRtl, AreTheModelsWithTwo) {
  random_traffic<Vchannels_2>(2, Arithmetic::precise, 1, 200000);
}

TEST(ChannelsRtl, AreTheModelsWithFour) {
  random_traffic<Vchannels_4>(4, Arithmetic::precise, 2, 200000);
}

TEST(ChannelsRtl, AreTheModelsWithSixteen) {
  random_traffic<Vchannels_16>(16, Arithmetic::precise, 3, 400000);
}

TEST(ChannelsRtl, AreTheModelsInPaper) {
  random_traffic<Vchannels_paper>(3, Arithmetic::paper, 4, 100000);
}

}  // namespace
}  // namespace capsoc::coprocessor
