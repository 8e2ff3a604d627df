// The log of a simulation's past and its snapshots, without a simulation.
#include "service/history.h"

#include <gtest/gtest.h>

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
  EXPECT_EQ(history.add(input(100)), std::nullopt);
  history.add_snapshot(at(150), 150, "state");
  EXPECT_EQ(history.add(input(200)), std::nullopt);
  history.add_snapshot(at(250), 250, "state");
  history.reach(at(300));
  history.stand_at(1);
  ASSERT_NE(history.next(), nullptr);
  EXPECT_EQ(history.next()->at, at(200));
  const auto ended = history.add(input(160, "y"));
  ASSERT_TRUE(ended.has_value());
  EXPECT_EQ(*ended, at(300));
  EXPECT_EQ(history.next(), nullptr);
  EXPECT_EQ(history.inputs().size(), 2U);
  EXPECT_EQ(history.inputs().back().at, at(160));
  EXPECT_EQ(history.snapshots().size(), 2U);
  EXPECT_EQ(history.end(), at(160));
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
