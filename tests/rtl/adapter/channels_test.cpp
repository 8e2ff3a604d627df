// Several channels in lockstep: model and RTL through the adapter, with copies and saved states of
// both.
#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <string>

#include "../../coprocessor/several_channels.h"
#include "base/archive.h"
#include "coprocessor/channel_register.h"
#include "coprocessor/coprocessor.h"
#include "rtl/coprocessor_rtl.h"
#include "rtl/lockstep.h"
#include "rtl/rtl_library.h"

namespace capsoc::rtl::test {
namespace {

using namespace coprocessor;

class SeveralChannels {
 public:
  explicit SeveralChannels(const Options& options, uint64_t seed)
      : options_(options), random_(seed), pair_(make()) {}

  void run(unsigned steps) {
    for (unsigned i = 0; i < steps && !pair_->difference(); ++i) {
      if (i % 1000 == 0) rate_ = 1 + below(30);
      cycle_ += 1 + below(120);
      if (below(32) < rate_) sample();
      if (below(3) == 0) access();
      if (below(400) == 0) through_a_saved_state();
    }
    pair_->advance(cycle_ + 2000);
    EXPECT_FALSE(pair_->difference()) << pair_->report("");
    EXPECT_GT(pair_->counters().commits, steps / 50);
  }

 private:
  std::unique_ptr<Lockstep> make() const {
    auto library = RtlLibrary::open(RtlLibrary::file_name(options_), options_);
    EXPECT_TRUE(library);
    return std::make_unique<Lockstep>(std::make_unique<Coprocessor>(options_),
                                      std::make_unique<CoprocessorRtl>(library.value()));
  }
  unsigned below(unsigned n) { return static_cast<unsigned>(random_() % n); }

  void sample() {
    pair_->submit_of(below(static_cast<unsigned>(options_.channels)), cycle_,
                     static_cast<int32_t>(random_()) >> below(4),
                     static_cast<int32_t>(random_()) >> below(4), below(8) == 0);
  }

  void access() {
    cycle_ += 2;
    const uint32_t offset = below(4) == 0 ? channel::offset : below(reg_last / 4 + 1) * 4;
    if (below(2) == 0) {
      pair_->read(cycle_, offset, below(4) == 0);
      cycle_ += 2;
      return;
    }
    auto value = static_cast<uint32_t>(random_());
    if (offset == channel::offset)
      value = below(static_cast<unsigned>(options_.channels)) |
              (below(2) == 0 ? channel::hold : 0) | channel::refused;
    // The RTL's memory of nodes begins with anything, so CORRECT stays 0.
    if (offset == reg_ctrl)
      value = (value & ~(ctrl_correct | (below(20) == 0 ? 0 : ctrl_srst))) | ctrl_adc;
    pair_->write(cycle_, offset, value);
  }

  void through_a_saved_state() {
    StateWriter writer;
    pair_->visit(writer);
    const std::string bytes = writer.take();
    auto other = make();
    StateReader reader(bytes);
    other->visit(reader);
    ASSERT_TRUE(reader.ok()) << reader.problem();
    pair_ = std::move(other);
    ++cycle_;
  }

  Options options_;
  std::mt19937_64 random_;
  std::unique_ptr<Lockstep> pair_;
  uint64_t cycle_ = 10;
  unsigned rate_ = 0;
};

TEST(ChannelsInLockstep, Four) {
  for (const uint64_t seed : {1, 2}) {
    SeveralChannels test(with_channels(4, Arithmetic::precise), seed);
    test.run(4000);
  }
}

TEST(ChannelsInLockstep, FourInPaper) {
  SeveralChannels test(with_channels(4, Arithmetic::paper), 3);
  test.run(3000);
}

TEST(ChannelsInLockstep, Sixteen) {
  SeveralChannels test(with_channels(16, Arithmetic::precise), 4);
  test.run(6000);
}

TEST(ChannelsInLockstep, AnotherNumberThanTheLibrarysIsRefused) {
  const Options four = with_channels(4, Arithmetic::precise);
  const auto library =
      RtlLibrary::open(RtlLibrary::file_name(four), with_channels(16, Arithmetic::precise));
  ASSERT_FALSE(library);
  EXPECT_NE(std::string(library.error()).find("channels for 4 sensors"), std::string::npos);
}

}  // namespace
}  // namespace capsoc::rtl::test
