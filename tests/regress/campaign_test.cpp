// The regression as a whole: it finds what is wrong, names it, and says the same however many
// threads it has.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <regex>

#include "coprocessor/coprocessor.h"
#include "faulty_model.h"
#include "regress/report.h"
#include "regress/rtl_comparison.h"
#include "regress/run_result.h"

namespace capsoc::regress::test {
namespace {

using coprocessor::Arithmetic;

Plan model_against_model() {
  Plan plan;
  plan.arithmetics = {Arithmetic::precise, Arithmetic::paper};
  plan.samples = 2000;
  plan.accesses = 2000;
  plan.seeds = 2;
  plan.compare = [](Arithmetic arithmetic) -> Result<std::unique_ptr<Comparison>> {
    coprocessor::Options options;
    options.arithmetic = arithmetic;
    return compare_with(options, std::make_unique<coprocessor::Coprocessor>(options));
  };
  return plan;
}

Plan model_against(const Fault& fault) {
  Plan plan = model_against_model();
  plan.arithmetics = {fault.arithmetic};
  plan.seeds = 1;
  plan.compare = [&fault](Arithmetic arithmetic) -> Result<std::unique_ptr<Comparison>> {
    coprocessor::Options options;
    options.arithmetic = arithmetic;
    return compare_with(options, std::make_unique<FaultyModel>(fault));
  };
  return plan;
}

// Both devices alike with the paper's arctangent as printed, which does not converge for these
// sensors: only the golden scenario sees it.
TEST(GoldenScenario, FindsAWrongAngleThatBothDevicesHave) {
  Plan plan = model_against_model();
  plan.scenarios = {"golden"};
  plan.arithmetics = {Arithmetic::paper};
  const auto right = run_campaign(plan);
  ASSERT_TRUE(right);
  ASSERT_EQ(right.value().first_failure(), nullptr)
      << right.value().first_failure()->finding->report;
  plan.compare = [](Arithmetic arithmetic) -> Result<std::unique_ptr<Comparison>> {
    coprocessor::Options options;
    options.arithmetic = arithmetic;
    options.paper_plain_arctangent = true;
    return compare_with(options, std::make_unique<coprocessor::Coprocessor>(options));
  };
  plan.seeds = 8;  // not every random sensor is out of its reach
  const auto outcome = run_campaign(plan);
  ASSERT_TRUE(outcome);
  const regress::Run* run = outcome.value().first_failure();
  ASSERT_NE(run, nullptr);
  EXPECT_EQ(run->finding->kind, Finding::Kind::wrong);
  // Of some sensors it has no angle at all, which is wrong as well.
  const auto& runs = outcome.value().runs;
  EXPECT_TRUE(std::any_of(runs.begin(), runs.end(), [](const regress::Run& each) {
    return each.finding &&
           each.finding->what.find("the coprocessor's angle differs") != std::string::npos;
  })) << run->finding->what;
  EXPECT_NE(to_text(Plan{}, outcome.value(), {}).find("ANGLE and the CSFN's angle"),
            std::string::npos);
}

class EveryFault : public testing::TestWithParam<size_t> {};

TEST_P(EveryFault, IsFoundAndNamed) {
  const Fault& fault = faults()[GetParam()];
  const auto outcome = run_campaign(model_against(fault));
  ASSERT_TRUE(outcome);
  const regress::Run* run = outcome.value().first_failure();
  ASSERT_NE(run, nullptr) << fault.name;
  bool named = false;
  std::string seen;
  for (const regress::Run& each : outcome.value().runs) {
    if (!each.finding) continue;
    named |= each.finding->node.rfind(fault.node, 0) == 0 &&
             each.finding->what.find(fault.what) != std::string::npos;
    seen += each.finding->what + " [" + each.finding->node + "]\n";
  }
  EXPECT_TRUE(named) << fault.name << ":\n" << seen;
  EXPECT_NE(run->finding->report.find("differ at cycle"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Regression, EveryFault, testing::Range<size_t>(0, faults().size()));

// The command that a report prints leads to the same difference.
TEST(Reproduction, RunsOneScenarioWithOneSeed) {
  const Fault& fault = faults().front();
  const auto all = run_campaign(model_against(fault));
  ASSERT_TRUE(all);
  const regress::Run* first = all.value().first_failure();
  ASSERT_NE(first, nullptr);
  Plan alone = model_against(fault);
  alone.scenarios = {first->scenario->name};
  alone.first_seed = first->seed;
  alone.samples = first->budget.samples;
  alone.accesses = first->budget.accesses;
  const auto again = run_campaign(alone);
  ASSERT_TRUE(again);
  ASSERT_EQ(again.value().runs.size(), 1u);
  ASSERT_TRUE(again.value().runs[0].finding);
  EXPECT_EQ(again.value().runs[0].finding->cycle, first->finding->cycle);
  EXPECT_EQ(again.value().runs[0].finding->what, first->finding->what);
  EXPECT_EQ(again.value().runs[0].command, first->command);
}

TEST(Campaign, OfEqualModelsFindsNothingAndCoversEveryBin) {
  const auto outcome = run_campaign(model_against_model());
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome.value().first_failure(), nullptr);
  for (const auto& [arithmetic, coverage] : outcome.value().coverage)
    for (const Coverage::Bin& bin : coverage.bins())
      EXPECT_GT(bin.hits, 0u) << name_of(arithmetic) << ": " << bin.group << ": " << bin.name;
}

TEST(Campaign, SaysTheSameWithAnyNumberOfJobs) {
  Plan plan = model_against_model();
  std::vector<std::string> texts;
  const std::regex times(" time=\"[0-9.]+\"");
  for (unsigned jobs : {1u, 2u, 5u}) {
    plan.jobs = jobs;
    const auto outcome = run_campaign(plan);
    ASSERT_TRUE(outcome);
    texts.push_back(to_json(plan, outcome.value(), {}).dump() +
                    to_text(Plan{}, outcome.value(), {}) +
                    std::regex_replace(to_junit(outcome.value()), times, ""));
  }
  EXPECT_EQ(texts[0], texts[1]);
  EXPECT_EQ(texts[0], texts[2]);
}

TEST(Campaign, RunsExactlyTheAmountsAskedForOrALittleMore) {
  Plan plan = model_against_model();
  plan.samples = 1003;
  plan.accesses = 507;
  const auto runs = runs_of(plan);
  ASSERT_TRUE(runs);
  uint64_t samples = 0, accesses = 0;
  for (const regress::Run& run : runs.value()) {
    if (run.arithmetic != Arithmetic::precise) continue;
    samples += run.budget.samples;
    accesses += run.budget.accesses;
  }
  EXPECT_GE(samples, 1003u);
  EXPECT_LE(samples, 1003u + scenarios().size());
  EXPECT_GE(accesses, 507u);
  EXPECT_LE(accesses, 507u + scenarios().size());
}

// One arithmetic does something terrible; the other one's runs do not notice.
void expect_no_result(void (*terrible)(), const std::string& what, const std::string& report) {
  const Fault fault{"terrible", "", "", Arithmetic::paper, {}, {}, {}, [terrible](bool level) {
                      terrible();
                      return level;
                    }};
  Plan plan = model_against_model();
  plan.scenarios = {"ties", "traffic"};
  plan.seconds = 2;
  plan.jobs = 2;
  plan.compare = [&](Arithmetic arithmetic) -> Result<std::unique_ptr<Comparison>> {
    coprocessor::Options options;
    options.arithmetic = arithmetic;
    if (arithmetic == Arithmetic::precise)
      return compare_with(options, std::make_unique<coprocessor::Coprocessor>(options));
    return compare_with(options, std::make_unique<FaultyModel>(fault));
  };
  const auto outcome = run_campaign(plan);
  ASSERT_TRUE(outcome) << outcome.error();
  EXPECT_TRUE(outcome.value().complete());
  for (const regress::Run& run : outcome.value().runs) {
    EXPECT_EQ(run.finding.has_value(), run.arithmetic == Arithmetic::paper);
    if (!run.finding) continue;
    EXPECT_EQ(run.finding->kind, Finding::Kind::no_result);
    EXPECT_EQ(run.finding->what.rfind(what, 0), 0u) << run.finding->what;
    EXPECT_NE(run.finding->report.find(report), std::string::npos) << run.finding->report;
  }
  const std::string text = to_text(Plan{}, outcome.value(), {});
  EXPECT_NE(text.find("NO RESULT in scenario "), std::string::npos) << text;
  EXPECT_EQ(text.find("no difference\n"), std::string::npos) << text;
}

TEST(Campaign, ARunThatHangsFailsAlone) {
  const auto hang = [] {
    for (volatile bool forever = true; forever;) {
    }
  };
  expect_no_result(hang, "out of time: it did not end within 2 s (--time-limit)", "");
}

TEST(Campaign, ARunThatCrashesFailsAlone) {
  const auto crash = [] {
    std::fputs("did not converge\n", stderr);
    std::abort();
  };
  expect_no_result(crash, "crashed: signal 6", "did not converge");
}

TEST(Campaign, ARunThatEndsItsProcessFailsAlone) {
  expect_no_result([] { _exit(0); }, "crashed: exit 0", "");
}

TEST(RunResult, WhatIsNoneIsRefused) {
  regress::Run run;
  Coverage coverage(Arithmetic::precise);
  const std::string whole = to_text(run, coverage);
  ASSERT_TRUE(take_text(whole, run, coverage));
  for (const std::string& text :
       {std::string(), std::string("null"), whole.substr(1), whole.substr(0, whole.size() / 2),
        to_text(run, Coverage(Arithmetic::paper)) + "x", std::string(R"({"counts":[1,2,3]})")})
    EXPECT_FALSE(take_text(text, run, coverage)) << text;
}

TEST(Campaign, RefusesAScenarioThatDoesNotExist) {
  Plan plan = model_against_model();
  plan.scenarios = {"trafic"};
  const auto outcome = run_campaign(plan);
  ASSERT_FALSE(outcome);
  EXPECT_NE(outcome.error().find("did you mean"), std::string::npos) << outcome.error();
  EXPECT_NE(outcome.error().find("traffic"), std::string::npos) << outcome.error();
}

}  // namespace
}  // namespace capsoc::regress::test
