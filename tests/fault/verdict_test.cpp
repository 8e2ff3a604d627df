// Verdicts on a run with a fault, each from what it did.
#include "fault/verdict.h"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "coprocessor/register_map.h"
#include "results/exit_codes.h"

namespace capsoc::fault {
namespace {

constexpr uint32_t good = coprocessor::status_valid | coprocessor::status_lock;
constexpr uint64_t count = 20;

uint32_t turns(double degrees) {
  return static_cast<uint32_t>(static_cast<int64_t>(degrees * 0x1p32 / 360));
}

SampleResult result(uint64_t number, double degrees) {
  SampleResult r;
  r.number = number;
  r.angle = turns(degrees);
  r.status = good;
  r.has_angle = true;
  return r;
}

using Results = std::vector<SampleResult>;

Results at_10_deg() {
  Results results;
  for (uint64_t i = 0; i < count; ++i) results.push_back(result(i, 10));
  return results;
}

/// From sample `first` to before `last` off by so much.
Results off(uint64_t first, uint64_t last, double degrees) {
  Results results = at_10_deg();
  for (uint64_t i = first; i < last; ++i) results[i].angle = turns(10 + degrees);
  return results;
}

Results lost(uint64_t first, uint64_t last) {
  Results results = at_10_deg();
  for (uint64_t i = first; i < last; ++i) results[i].exists = false;
  return results;
}

Judgement judged(const Results& results) {
  Judgement judgement({0.1, 3});
  const Results golden = at_10_deg();
  for (uint64_t i = 0; i < count; ++i) judgement.take(golden[i], &results[i]);
  return judgement;
}

Verdict verdict(const Results& results, const Ending& ending = {}) {
  return judged(results).conclude(ending);
}

Ending with_code(int code) {
  Ending ending;
  ending.code = code;
  return ending;
}

Ending same_state() {
  Ending ending;
  ending.is_same_state = true;
  return ending;
}

TEST(Verdict, NothingWrongIsMaskedIfTheStateIsTheSame) {
  EXPECT_EQ(verdict(at_10_deg(), same_state()), Verdict::masked);
  EXPECT_EQ(verdict(at_10_deg()), Verdict::latent);
  EXPECT_EQ(verdict(off(5, count, 0.05)), Verdict::latent);
  EXPECT_EQ(verdict(off(5, count, 0.05), same_state()), Verdict::masked);
}

TEST(Verdict, MoreWrongAnglesThanAllowedAreSilent) {
  EXPECT_EQ(verdict(off(5, 8, 0.2)), Verdict::wrong);
  EXPECT_EQ(verdict(off(5, 9, 0.2)), Verdict::silent);
  EXPECT_EQ(verdict(off(5, 9, -0.2)), Verdict::silent);
  // The way back to the same state does not undo them.
  EXPECT_EQ(verdict(off(5, 9, 0.2), same_state()), Verdict::silent);
  EXPECT_EQ(verdict(off(5, 8, 0.2), same_state()), Verdict::wrong);
}

TEST(Verdict, AnglesThatDoNotComeAreWrong) {
  EXPECT_EQ(verdict(lost(5, 8)), Verdict::wrong);
  EXPECT_EQ(verdict(lost(5, 9)), Verdict::silent);
  Judgement none({0.1, 3});
  for (const SampleResult& golden : at_10_deg()) none.take(golden, nullptr);
  EXPECT_EQ(none.conclude({}), Verdict::silent);
  // Said before.
  Results results = lost(6, count);
  results[5].status = coprocessor::status_valid;
  EXPECT_EQ(verdict(results), Verdict::detected);
}

TEST(Verdict, AnglesWrapAround) {
  Judgement judgement({0.1, 3});
  for (uint64_t i = 0; i < count; ++i) {
    const SampleResult golden = result(i, 359.99), mine = result(i, 0.04);
    judgement.take(golden, &mine);
  }
  EXPECT_NEAR(judgement.largest_deg(), 0.05, 1e-6);
  EXPECT_EQ(judgement.conclude({}), Verdict::latent);
}

TEST(Verdict, WhatASampleWithoutAnAngleShowsIsNoError) {
  Judgement judgement({0.1, 3});
  for (uint64_t i = 0; i < count; ++i) {
    SampleResult golden = result(i, 10), mine = result(i, 100);
    golden.has_angle = mine.has_angle = false;
    judgement.take(golden, &mine);
  }
  EXPECT_EQ(judgement.conclude({}), Verdict::latent);
}

struct Detection {
  const char* by;
  std::function<void(SampleResult&)> change;
};

TEST(Verdict, EachFlagDetectsAndCountsFromTheFirstWrongAngle) {
  const std::vector<Detection> all = {
      {"no LOCK", [](SampleResult& r) { r.status &= ~uint32_t{coprocessor::status_lock}; }},
      {"no VALID", [](SampleResult& r) { r.status &= ~uint32_t{coprocessor::status_valid}; }},
      {"DIVERGED", [](SampleResult& r) { r.status |= coprocessor::status_diverged; }},
      {"MIRROR", [](SampleResult& r) { r.status |= coprocessor::status_mirror; }},
      {"ALARM", [](SampleResult& r) { r.status |= coprocessor::status_alarm; }},
      {"CLIP", [](SampleResult& r) { r.flags |= coprocessor::flag_clip; }},
      {"SAT", [](SampleResult& r) { r.flags |= coprocessor::flag_sat; }},
      {"ZERO", [](SampleResult& r) { r.flags |= coprocessor::flag_zero; }},
      {"EARLY", [](SampleResult& r) { r.flags |= coprocessor::flag_early; }},
      {"LOCKCHG", [](SampleResult& r) { r.flags |= coprocessor::flag_lockchg; }},
      {"CONFIG", [](SampleResult& r) { r.flags |= coprocessor::flag_config; }},
      {"UNSETTLED", [](SampleResult& r) { r.flags |= coprocessor::flag_unsettled; }}};
  for (const Detection& each : all) {
    SCOPED_TRACE(each.by);
    Results results = off(5, count, 0.2);
    each.change(results[7]);
    const Judgement in_time = judged(results);
    EXPECT_EQ(in_time.detected_by(), each.by);
    EXPECT_EQ(in_time.detected_after(), 2u);
    EXPECT_EQ(in_time.conclude({}), Verdict::detected);
    results = off(5, count, 0.2);
    each.change(results[3]);
    EXPECT_EQ(judged(results).detected_after(), 0u);
    EXPECT_EQ(judged(results).trusted(), 0u);
    // More than three were wrong before.
    results = off(5, count, 0.2);
    each.change(results[15]);
    EXPECT_EQ(judged(results).detected_after(), 10u);
    EXPECT_EQ(verdict(results), Verdict::silent);
  }
}

TEST(Verdict, WhatIsSoWithoutTheFaultDetectsNothing) {
  Judgement judgement({0.1, 3});
  for (uint64_t i = 0; i < count; ++i) {
    SampleResult golden = result(i, 10);
    golden.status = coprocessor::status_alarm;
    golden.flags = coprocessor::flag_sat;
    const SampleResult mine = golden;
    judgement.take(golden, &mine);
  }
  EXPECT_EQ(judgement.detected_by(), "");
}

TEST(Verdict, TheProgramsEndCounts) {
  EXPECT_EQ(verdict(at_10_deg(), with_code(run::exit_code::failed)), Verdict::detected);
  EXPECT_EQ(verdict(off(5, 8, 0.2), with_code(run::exit_code::failed)), Verdict::detected);
  EXPECT_EQ(verdict(off(5, 8, 0.2), with_code(run::exit_code::crashed)), Verdict::crashed);
  EXPECT_EQ(verdict(off(5, 8, 0.2), with_code(run::exit_code::limit)), Verdict::hung);
  // What was wrong before, or detected, stays so.
  EXPECT_EQ(verdict(off(5, 9, 0.2), with_code(run::exit_code::crashed)), Verdict::silent);
  EXPECT_EQ(verdict(off(5, 9, 0.2), with_code(run::exit_code::limit)), Verdict::silent);
  Results results = off(5, 8, 0.2);
  results[6].status = coprocessor::status_valid;
  EXPECT_EQ(verdict(results, with_code(run::exit_code::limit)), Verdict::detected);
}

TEST(Verdict, AProgramThatHasNoEndDoesNotHang) {
  Ending endless = same_state();
  endless.code = endless.golden_code = run::exit_code::limit;
  EXPECT_EQ(verdict(at_10_deg(), endless), Verdict::masked);
  endless.is_same_state = false;
  EXPECT_EQ(verdict(off(5, 8, 0.2), endless), Verdict::wrong);
  endless.code = run::exit_code::pass;
  EXPECT_EQ(verdict(at_10_deg(), endless), Verdict::detected);
}

TEST(Verdict, TheProgramsEndDetectsInTheNewestSample) {
  const Results results = off(5, count, 0.2), golden = at_10_deg();
  Judgement judgement({0.1, 3});
  for (uint64_t i = 0; i < 7; ++i) judgement.take(golden[i], &results[i]);
  judgement.note_end();
  EXPECT_EQ(judgement.detected_by(), "");
  EXPECT_EQ(judgement.detected_after(), 1u);
  EXPECT_EQ(judgement.conclude(with_code(run::exit_code::failed)), Verdict::detected);
  EXPECT_EQ(judgement.conclude(with_code(run::exit_code::crashed)), Verdict::crashed);
}

TEST(Verdict, AFaultThatDidNotHappenIsNotMasked) {
  Ending ending = same_state();
  ending.is_applied = false;
  EXPECT_EQ(verdict(at_10_deg(), ending), Verdict::unapplied);
}

}  // namespace
}  // namespace capsoc::fault
