#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <map>
#include <utility>

#include "armv7m/core.h"

namespace capsoc::armv7m::test {

/// What ExecutionCounts says, counted instruction by instruction.
class StepCounts : public Observer {
 public:
  explicit StepCounts(Core& core) : core_(core) { core_.add_observer(*this, true, false); }
  ~StepCounts() override { core_.remove_observer(*this); }
  StepCounts(const StepCounts&) = delete;
  StepCounts& operator=(const StepCounts&) = delete;

  struct Count {
    uint64_t executed = 0, skipped = 0, taken = 0;
    bool operator==(const Count& o) const {
      return executed == o.executed && skipped == o.skipped && taken == o.taken;
    }
  };
  /// By halfword.
  const std::map<uint32_t, Count>& counts() const { return counts_; }

  /// The registers R0 to R14 that instructions have changed since the last call, a bit each.
  uint32_t take_changed() { return std::exchange(changed_, 0); }

  void issued(const Core& core, const DecodedOp& op) override {
    const State& state = core.state();
    before_ = registers(core);
    const bool skips = op.condition != condition_always && !state.condition_passed(op.condition);
    for (uint32_t at = op.address; at != next_address(op); at += 2) {
      ++counts_[at].executed;
      if (skips) ++counts_[at].skipped;
    }
    if (!skips && takes(state, op)) ++counts_[op.address].taken;
  }
  void retired(const Core& core, const DecodedOp&) override {
    const auto now = registers(core);
    for (unsigned n = 0; n < now.size(); ++n)
      if (now[n] != before_[n]) changed_ |= 1U << n;
  }
  void entered(const Core&, unsigned, Entry, uint64_t) override {}
  void returned(const Core&, unsigned) override {}
  void accessed(const Core&, const DirectAccess&) override {}
  void started(const Core&) override {}

 private:
  using Registers = std::array<uint32_t, 15>;
  static Registers registers(const Core& core) {
    Registers all{};
    for (unsigned n = 0; n < all.size(); ++n) all[n] = core.reg(n);
    return all;
  }
  static bool takes(const State& state, const DecodedOp& op) {
    switch (op.operation) {
      case Operation::bcond:
        return state.condition_passed(branch_condition(op));
      case Operation::cbz:
        return state.r[op.rn] == 0;
      case Operation::cbnz:
        return state.r[op.rn] != 0;
      default:
        return false;
    }
  }

  Core& core_;
  std::map<uint32_t, Count> counts_;
  Registers before_{};
  uint32_t changed_ = 0;
};

inline void expect_same_counts(const StepCounts& steps, const ExecutionCounts& counts) {
  std::map<uint32_t, StepCounts::Count> found;
  for (const auto& [number, totals] : counts.totals()) {
    for (uint32_t i = 0; i < ExecutionCounts::halfwords; ++i) {
      const StepCounts::Count count{totals.executed[i], totals.skipped[i], totals.taken[i]};
      if (!(count == StepCounts::Count{}))
        found[(number << ExecutionCounts::page_bits) + 2 * i] = count;
    }
  }
  for (const auto& [address, count] : steps.counts()) {
    const StepCounts::Count& other = found[address];
    ASSERT_EQ(count.executed, other.executed) << std::hex << address;
    ASSERT_EQ(count.skipped, other.skipped) << std::hex << address;
    ASSERT_EQ(count.taken, other.taken) << std::hex << address;
  }
  ASSERT_EQ(steps.counts().size(), found.size());
}

}  // namespace capsoc::armv7m::test
