// Sleep, thread and handlers against a record that forgets nothing.
#include "service/activity_record.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <vector>

namespace capsoc::service {
namespace {

using Slices = std::vector<std::pair<uint64_t, uint64_t>>;
constexpr uint64_t us = 1'000'000, ms = 1000 * us, second = 1000 * ms;
constexpr uint64_t asleep = 1U << ActivityRecord::asleep, thread = 1U << ActivityRecord::thread;

/// Every slice since the beginning, and the record.
class Both {
 public:
  explicit Both(uint64_t ps) { record.begin(ps, thread), change_all(ps, thread, 0); }

  void change(uint64_t ps, uint64_t parts, unsigned entered = 0) {
    record.change(ps, parts, entered);
    change_all(ps, parts, entered);
  }

  void compare(std::size_t window, uint64_t now) {
    const ActivityRecord::View view = record.view(window, now);
    EXPECT_EQ(view.end_ps, now);
    EXPECT_GE(view.known_ps, view.begin_ps);
    EXPECT_LE(view.begin_ps, now);
    EXPECT_GE(view.begin_ps + ActivityRecord::windows[window], now);
    std::size_t count = 0;
    for (const ActivityRecord::Row& row : view.rows) {
      uint64_t busy = 0, begun = 0;
      Slices slices;
      std::vector<uint64_t> bins(ActivityRecord::bin_count);
      for (auto [begin, end] : all_of(row.part, now)) {
        if (begin >= view.known_ps && begin > first_) ++begun;
        if (end <= view.begin_ps) continue;
        slices.emplace_back(begin, end);
        begin = std::max(begin, view.known_ps);
        if (end > begin) busy += end - begin;
        for (uint64_t at = begin; at < end;) {
          const uint64_t bin = (at - view.begin_ps) / view.width_ps;
          const uint64_t next = std::min(end, view.begin_ps + (bin + 1) * view.width_ps);
          bins[bin] += next - at;
          at = next;
        }
      }
      count += slices.size();
      EXPECT_EQ(row.busy_ps, busy);
      EXPECT_EQ(row.begun, begun);
      if (view.has_slices)
        EXPECT_EQ(row.slices, slices);
      else
        EXPECT_EQ(row.bins, bins);
    }
    if (view.has_slices)
      EXPECT_LE(count, ActivityRecord::most_slices);
    else
      EXPECT_GT(count, ActivityRecord::most_slices);
    ++(view.has_slices ? sliced : binned);
  }

  ActivityRecord record;
  unsigned sliced = 0, binned = 0;

 private:
  void change_all(uint64_t ps, uint64_t parts, unsigned entered) {
    if (closed_.empty()) first_ = ps;
    for (unsigned part = 0; part < 64; ++part) {
      const bool was = open_.count(part) > 0, is = (parts >> part & 1U) != 0;
      const bool again = entered != 0 && part == entered;
      if (was && (!is || again)) {
        closed_[part].emplace_back(open_[part], ps);
        open_.erase(part);
      }
      if (is && (!was || again)) open_[part] = ps;
    }
    closed_[0];
  }

  Slices all_of(unsigned part, uint64_t now) {
    Slices all = closed_[part];
    if (open_.count(part) > 0 && open_[part] < now) all.emplace_back(open_[part], now);
    return all;
  }

  uint64_t first_ = 0;
  std::map<unsigned, uint64_t> open_;
  std::map<unsigned, Slices> closed_;
};

TEST(ActivityRecord, IsWhatHappened) {
  std::mt19937_64 draw(20261128);
  unsigned sliced = 0, binned = 0;
  for (const uint64_t usual : {us / 5, 3 * us, 50 * us, 2 * ms, 200 * ms}) {
    Both both(7 * us);
    uint64_t now = 7 * us, active = 0;
    unsigned last = 0;
    for (unsigned i = 0; i < 30'000; ++i) {
      now += 1 + draw() % (2 * usual);
      if (draw() % 100 == 0) now += draw() % (50 * usual);  // a long rest
      const unsigned handler = 15 + static_cast<unsigned>(draw() % 5);
      const uint64_t bit = ActivityRecord::bit(handler);
      unsigned entered = 0;
      if (draw() % 2 == 0 && (active == 0 || (active & bit) == 0)) {
        active |= bit;
        entered = last = handler;
      } else if (active != 0 && draw() % 4 == 0) {
        entered = last;  // again, one after the other
        active |= ActivityRecord::bit(last);
      } else {
        active &= active - 1;
      }
      const uint64_t rest = draw() % 3 == 0 ? asleep : thread;
      both.change(now, active != 0 ? active : rest, entered);
      if (draw() % 500 != 0) continue;
      for (std::size_t window = 0; window < ActivityRecord::windows.size(); ++window)
        both.compare(window, now + draw() % usual);
      if (HasFailure()) return;
    }
    sliced += both.sliced;
    binned += both.binned;
  }
  EXPECT_GT(sliced, 300U);
  EXPECT_GT(binned, 300U);
}

TEST(ActivityRecord, ANewOneKnowsNothing) {
  ActivityRecord record;
  record.begin(second, asleep);
  const ActivityRecord::View view = record.view(3, second + ms);
  EXPECT_EQ(view.known_ps, second);
  ASSERT_EQ(view.rows.size(), 1U);
  EXPECT_EQ(view.rows[0].slices, (Slices{{second, second + ms}}));
  EXPECT_EQ(view.rows[0].begun, 0U);
  record.begin(us, thread);
  EXPECT_EQ(record.view(0, us).rows[0].part, unsigned{ActivityRecord::thread});
}

TEST(ActivityRecord, WhatLastsNoTimeIsNotThere) {
  ActivityRecord record;
  record.begin(0, ActivityRecord::bit(20));
  record.change(ms, thread);  // returns, and sleeps at once
  record.change(ms, asleep);
  record.change(2 * ms, ActivityRecord::bit(20), 20);
  record.change(3 * ms, ActivityRecord::bit(20), 20);
  const ActivityRecord::View view = record.view(1, 4 * ms);
  ASSERT_EQ(view.rows.size(), 3U);
  EXPECT_TRUE(view.rows[1].slices.empty());
  EXPECT_EQ(view.rows[1].begun, 0U);
  EXPECT_EQ(view.rows[2].slices, (Slices{{0, ms}, {2 * ms, 3 * ms}, {3 * ms, 4 * ms}}));
  EXPECT_EQ(view.rows[2].begun, 2U);
}

}  // namespace
}  // namespace capsoc::service
