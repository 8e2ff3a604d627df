// The log of a simulation's past and its snapshots, without a simulation.
#include "service/history.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace capsoc::service {
namespace {

constexpr std::size_t kib = 1024;

Position at(uint64_t time) {
  return {time, time * 2, time * 3, time / 10};
}

Input input(uint64_t time, const char* text = "x") {
  return {at(time), "uart.send", {{"uart", 0}, {"bytes", text}}, {}};
}

History begun(std::size_t budget = kib * kib) {
  History history(budget);
  history.begin({}, "");
  return history;
}

TEST(History, KeepsNothingWithoutABudgetOrABeginning) {
  History none(0);
  none.begin({}, "state");
  EXPECT_FALSE(none.is_on());
  EXPECT_FALSE(History(kib).is_on());
  EXPECT_TRUE(begun().is_on());
}

TEST(History, FindsTheSnapshotBeforeATarget) {
  History history = begun();
  for (uint64_t time = 100; time <= 500; time += 100) history.add_snapshot(at(time), time, "state");
  EXPECT_EQ(history.before(Target{Unit::time, 0}), 0U);
  EXPECT_EQ(history.before(Target{Unit::time, 301}), 3U);
  // The first instant at which it is reached may be before the snapshot.
  EXPECT_EQ(history.before(Target{Unit::time, 300}), 2U);
  EXPECT_EQ(history.before(Target{Unit::cycles, 401}), 2U);
  EXPECT_EQ(history.before(Target{Unit::instructions, 1501}), 5U);
  EXPECT_EQ(history.before(Target{Unit::samples, 20}), 1U);
  EXPECT_EQ(history.before(at(300)), 3U);
  EXPECT_EQ(history.before(at(299)), 2U);
}

TEST(History, AnInputInThePastBeginsAnotherFuture) {
  History history = begun();
  EXPECT_FALSE(history.add(input(100)));
  history.add_snapshot(at(150), 150, "state");
  EXPECT_FALSE(history.add(input(200)));
  history.add_snapshot(at(250), 250, "state");
  history.reach(at(300));
  history.stand_at(1);
  ASSERT_NE(history.next(), nullptr);
  EXPECT_EQ(history.next()->at, at(200));
  const auto ended = history.add(input(160, "y"));
  ASSERT_TRUE(ended.has_value());
  EXPECT_EQ(ended->at, at(300));
  EXPECT_EQ(ended->number, 1U);
  EXPECT_EQ(history.number(), 2U);
  ASSERT_EQ(history.left().size(), 1U);
  EXPECT_EQ(history.left()[0].from, at(160));
  EXPECT_EQ(history.left()[0].end, at(300));
  EXPECT_EQ(history.left()[0].inputs.size(), 2U);
  EXPECT_EQ(history.next(), nullptr);
  EXPECT_EQ(history.inputs().size(), 2U);
  EXPECT_EQ(history.inputs().back()->at, at(160));
  EXPECT_EQ(history.snapshots().size(), 2U);
  EXPECT_EQ(history.end(), at(160));
}

/// Histories as lists of inputs, to compare with. A snapshot is the list of the inputs before it.
class Walk {
 public:
  explicit Walk(std::size_t budget) : history_(begun(budget)) { all_[1] = {}; }

  void go(uint64_t time) {
    history_.stand_at(history_.before(at(time)));
    while (history_.next() != nullptr && history_.next()->at <= at(time)) history_.pass_next();
    history_.reach(at(time));
    all_[history_.number()].end = std::max(all_[history_.number()].end, time);
    now_ = time;
  }
  void add() {
    const uint64_t before = history_.number();
    Line line = all_[before];
    const bool is_new = now_ < line.end;
    line.inputs.resize(history_.passed());
    line.inputs.push_back({now_, std::to_string(++count_)});
    line.end = now_;
    const auto ended = history_.add(input(now_, line.inputs.back().second.c_str()));
    ASSERT_EQ(ended.has_value(), is_new);
    if (is_new) {
      EXPECT_EQ(ended->at, at(all_[before].end));
      EXPECT_EQ(ended->number, before);
      EXPECT_EQ(history_.number(), all_.rbegin()->first + 1);
    }
    all_[history_.number()] = std::move(line);
  }
  void keep() {
    std::string state;
    for (uint64_t i = 0; i < history_.passed(); ++i)
      state += all_[history_.number()].inputs[i].second + ' ';
    history_.add_snapshot(at(now_), now_, state + std::string(100, 's'));
  }
  void select(uint64_t number) {
    ASSERT_TRUE(history_.select(number));
    go(all_[number].end);
  }
  void over_there() {
    // By a process that has some of the snapshots.
    std::set<uint64_t> known;
    for (const History::Snapshot& each : spare_.snapshots()) known.insert(each.serial);
    Frames frames;
    const Json about = history_.pack(frames, known);
    spare_ = std::move(History::unpack(about, frames, std::move(spare_)).value());
    history_ = spare_;
    history_.stand_at(history_.before(at(now_)));
    while (history_.next() != nullptr && history_.next()->at <= at(now_)) history_.pass_next();
  }

  void check() {
    compare(history_.number(), history_.inputs(), history_.end());
    for (const History::Left& left : history_.left()) {
      compare(left.number, left.inputs, left.end);
      const Line &one = all_[left.number], &present = all_[history_.number()];
      uint64_t from = std::min(one.end, present.end);
      for (std::size_t i = 0; i < std::max(one.inputs.size(), present.inputs.size()); ++i) {
        const bool both = i < one.inputs.size() && i < present.inputs.size();
        if (both && one.inputs[i] == present.inputs[i]) continue;
        for (const Line* line : {&one, &present})
          if (i < line->inputs.size()) from = std::min(from, line->inputs[i].first);
        break;
      }
      EXPECT_EQ(left.from, at(from)) << left.number;
    }
    const Line& present = all_[history_.number()];
    for (const History::Snapshot& each : history_.snapshots()) {
      if (each.bytes.empty()) continue;
      std::string state;
      for (uint64_t i = 0; i < each.inputs; ++i) state += present.inputs.at(i).second + ' ';
      EXPECT_EQ(each.bytes.substr(0, each.bytes.find('s')), state);
      if (each.inputs < present.inputs.size()) {
        EXPECT_LE(each.at, at(present.inputs[each.inputs].first));
      }
    }
  }
  const History& history() const { return history_; }
  uint64_t beginning() const { return history_.beginning().time_ps; }

 private:
  struct Line {
    std::vector<std::pair<uint64_t, std::string>> inputs;
    uint64_t end = 0;
  };

  void compare(uint64_t number, const History::Inputs& inputs, const Position& end) {
    const Line& line = all_[number];
    EXPECT_EQ(end, at(line.end)) << number;
    const auto dropped = history_.snapshots().front().inputs;
    ASSERT_EQ(inputs.size() + dropped, line.inputs.size()) << number;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      EXPECT_EQ(inputs[i]->at, at(line.inputs[dropped + i].first));
      EXPECT_EQ(inputs[i]->parameters.at("bytes"), Json(line.inputs[dropped + i].second));
    }
  }

  History history_, spare_;
  std::map<uint64_t, Line> all_;
  uint64_t now_ = 0, count_ = 0;
};

TEST(History, ThoseThatWereLeftCanBeSelected) {
  constexpr unsigned seed = 20261127;
  std::mt19937 random(seed);
  unsigned selected = 0, moved = 0;
  std::size_t most = 0;
  for (unsigned round = 0; round < 200; ++round) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", round " + std::to_string(round));
    static constexpr std::size_t budgets[] = {kib * kib, 8 * kib, 2 * kib};
    Walk walk(budgets[round % 3]);
    for (unsigned step = 0; step < 100; ++step) {
      const uint64_t end = walk.history().end().time_ps, begin = walk.beginning();
      switch (random() % 6) {
        case 0:
          walk.go(end + 10 + random() % 100);
          break;
        case 1:
          walk.go(begin + random() % (end - begin + 1));
          break;
        case 2:
          walk.keep();
          break;
        case 3:
          if (const auto& left = walk.history().left(); !left.empty()) {
            walk.select(left[random() % left.size()].number);
            ++selected;
          }
          break;
        case 4:
          walk.over_there();
          break;
        default:
          walk.add();
      }
      walk.check();
      if (::testing::Test::HasFailure()) return;
      most = std::max(most, walk.history().left().size());
    }
    moved += walk.beginning() > 0 ? 1 : 0;
    if (walk.history().snapshots().size() > 1) {
      EXPECT_LE(walk.history().bytes(), walk.history().budget());
    }
  }
  EXPECT_GT(selected, 1000U);
  EXPECT_GT(moved, 20U);
  EXPECT_LE(most, History::most_left);
  EXPECT_GT(most, 5U);
  EXPECT_FALSE(begun().select(1));
}

TEST(History, IsThinnedWithAgeWithinItsBudget) {
  const std::string state(10 * kib, 's');
  History history = begun(200 * kib);
  for (uint64_t time = 1; time <= 1000; ++time) history.add_snapshot(at(time), time, state);
  EXPECT_LE(history.bytes(), 200 * kib);
  const auto& kept = history.snapshots();
  EXPECT_EQ(kept.front().at, at(0));
  EXPECT_EQ(kept.back().at, at(1000));
  ASSERT_GT(kept.size(), 10U);
  EXPECT_LT(kept.back().at.time_ps - kept[kept.size() - 2].at.time_ps, 20U);
  EXPECT_GT(kept[2].at.time_ps - kept[1].at.time_ps, 20U);
  EXPECT_EQ(history.kept_before(kept.front()), 0);
}

TEST(History, NeverHasTooManySnapshots) {
  History history = begun();
  for (uint64_t time = 1; time <= 2000; ++time) history.add_snapshot(at(time), time, "s");
  EXPECT_EQ(history.snapshots().size(), History::most_snapshots);
}

TEST(History, TheBeginningMovesWhenNothingElseFits) {
  History history = begun(40 * kib);
  for (uint64_t time = 1; time <= 100; ++time) {
    history.add(input(10 * time, std::string(kib, 'i').c_str()));
    history.add_snapshot(at(10 * time + 5), time, std::string(5 * kib, 's'));
  }
  EXPECT_LE(history.bytes(), 40 * kib);
  EXPECT_LT(at(0), history.beginning());
  EXPECT_GT(history.snapshots().front().inputs, 0U);
  EXPECT_EQ(history.kept_before(history.snapshots().front()), 0);
  EXPECT_GT(history.kept_before(history.snapshots().back()), 0);
  history.stand_at(0);
  ASSERT_NE(history.next(), nullptr);
  EXPECT_LT(history.beginning(), history.next()->at);
  EXPECT_LE(history.next()->at.time_ps, history.beginning().time_ps + 5);
}

TEST(History, IsTheSameInAnotherProcess) {
  History history = begun();
  history.add({at(100), "memory.write", {{"address", 5}}, {std::string("\0\n{", 3), ""}});
  history.add_snapshot(at(150), 77, std::string("\xff\0state", 7));
  history.add(input(200));
  Frames frames = {"another one's"};
  const Json about = Json::parse(history.pack(frames).dump());
  auto copy = History::unpack(about, frames);
  ASSERT_TRUE(copy) << copy.error();
  Frames again = {"another one's"};
  EXPECT_EQ(copy.value().pack(again), about);
  EXPECT_EQ(again, frames);
  EXPECT_EQ(copy.value().bytes(), history.bytes());
  copy.value().stand_at(0);
  EXPECT_EQ(copy.value().next()->frames.at(0), std::string("\0\n{", 3));
}

TEST(History, SnapshotsThatAreKnownAreNotSentAgain) {
  History history = begun();
  history.add_snapshot(at(100), 1, "one");
  Frames frames;
  const Json all = history.pack(frames);
  auto other = History::unpack(all, frames);
  ASSERT_TRUE(other) << other.error();
  history.add_snapshot(at(200), 2, "two");
  Frames fewer;
  const Json rest = history.pack(fewer, {1, 2});
  EXPECT_EQ(fewer.size(), frames.size() - 1);
  EXPECT_EQ(fewer.back(), "two");
  EXPECT_FALSE(History::unpack(rest, fewer));
  auto both = History::unpack(rest, fewer, std::move(other.value()));
  ASSERT_TRUE(both) << both.error();
  Frames here, there;
  EXPECT_EQ(both.value().pack(here), history.pack(there));
  EXPECT_EQ(here, there);
}

TEST(Inputs, DamageIsRefused) {
  const std::string good = to_bytes(input(100)) + to_bytes(input(200));
  ASSERT_TRUE(inputs_in(good));
  EXPECT_EQ(inputs_in(good).value().size(), 2U);
  EXPECT_FALSE(inputs_in(good.substr(0, good.size() - 2)));
  EXPECT_FALSE(inputs_in(good + "{}\n"));
  EXPECT_FALSE(inputs_in(to_bytes(input(200)) + to_bytes(input(100))));
}

}  // namespace
}  // namespace capsoc::service
