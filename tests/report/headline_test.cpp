// The digits of numbers, and answers of results in which nothing is as it should be.
#include "report/headline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "report/number_text.h"
#include "report/page.h"

namespace capsoc::report {
namespace {

TEST(Numbers, HaveTheDigitsThatMeanSomething) {
  EXPECT_EQ(three_digits(0), "0");
  EXPECT_EQ(three_digits(25.3637), "25.4");
  EXPECT_EQ(three_digits(5.8673e-7), "5.87e-07");
  EXPECT_EQ(three_digits(3337.9), "3338");
  EXPECT_EQ(three_digits(-999999), "-999999");
  EXPECT_EQ(three_digits(4734931), "4.73 million");
  EXPECT_EQ(three_digits(47349310), "47.3 million");
  EXPECT_EQ(three_digits(4.7e14), "4.7e+14");
  EXPECT_EQ(shortened("25.363720166172588"), "25.364");
  EXPECT_EQ(shortened("105001"), "105001");
  EXPECT_EQ(shortened("0.607900"), "0.607900");
  EXPECT_EQ(percent(0.925), "92.50 %");
  EXPECT_EQ(counted(1, "value") + ", " + counted(0, "value"), "1 value, 0 values");
}

TEST(Numbers, ThatDifferAreToldApart) {
  using Texts = std::pair<std::string, std::string>;
  EXPECT_EQ(told_apart(1, 2, 3), Texts("1", "2"));
  EXPECT_EQ(told_apart(3337.9, 3282.1, 3), Texts("3338", "3282"));
  EXPECT_EQ(told_apart(0.6079, 0.607898, 3), Texts("0.6079", "0.607898"));
  EXPECT_EQ(told_apart(420.5, 420.50001, 3), Texts("420.5", "420.50001"));
  const double next = std::nextafter(1.0, 2.0);
  EXPECT_EQ(told_apart(1, next, 3), Texts("1", "1.0000000000000002"));
}

TEST(Headlines, AreThereOrNotWhateverTheResultHolds) {
  const char* wrong[] = {
      R"({"command": "capsoc campaign", "yield": "x", "worst": 3, "criteria": {"a": 1}})",
      R"({"command": "capsoc campaign", "yield": 1, "done": 0, "yield_interval": [1, "x"], "criteria": [1, {}]})",
      R"({"command": "capsoc reproduce", "tables": [{"rows": [{}, 1, {"verdict": 7}]}, 3]})",
      R"({"command": "capsoc accuracy", "tables": [{"rows": [{"precise": 1, "bound": 0}]}]})",
      R"({"command": "capsoc bench cpu", "tables": [{"id": "cpu", "rows": [null]}]})",
      R"({"schema": "capsoc-regress-1", "arithmetics": {"precise": {"runs": [1, {}], "coverage": [1, [2]]}}})",
      R"({"schema": "capsoc-regress-1", "partial": 1, "arithmetics": 2})",
      R"({"schema": "capsoc-mutation-1", "arithmetics": {"paper": {"files": {"a": 1, "b": []}}}})"};
  for (const char* text : wrong) {
    const Json json = Json::parse(text);
    EXPECT_GT(page_of({{"", json}}).size(), 1000U) << text;
    EXPECT_GT(page_of({{"a", json}, {"b", json}}).size(), 1000U) << text;
  }
}

TEST(Headlines, OfARegressionCountBothArithmetics) {
  const auto part = [](int cycles, int covered) {
    return Json{
        {"runs", {{{"scenario", "x"}, {"seed", 1}, {"cycles", cycles}, {"samples", 5}}}},
        {"coverage", {{"g", {{"a", 1}, {"b", covered}}}}},
        {"rtl_coverage", {{"line", {{"points", 10}, {"covered", covered}, {"excepted", 2}}}}}};
  };
  const Json result = {{"schema", "capsoc-regress-1"},
                       {"arithmetics", {{"precise", part(1000, 8)}, {"paper", part(500, 0)}}}};
  const Headline headline = headline_of(result);
  EXPECT_EQ(
      headline.sentence,
      "No difference between the model and the RTL: 2 runs, 1500 clocks, 10 samples. But 1 of "
      "4 coverage bins are missing");
  EXPECT_EQ(headline.style, std::string("odd"));
  ASSERT_EQ(headline.figures.size(), 4U);
  EXPECT_EQ(headline.figures[3].label, "RTL line coverage");
  EXPECT_EQ(headline.figures[3].value, "50.00 %");
  EXPECT_EQ(headline.figures[3].exact, "8 of 16");
}

TEST(Headlines, OfABenchNameWhatWentWrong) {
  const auto sentence = [](const char* first, const char* last) {
    const Json rows = {{{"program", "p"}, {"verdict", first}},
                       {{"program", "geometric mean"},
                        {"verdict", last},
                        {"icount_ratio", 0.5},
                        {"translator_mips", 123.4},
                        {"translator_ratio", 0}}};
    return headline_of({{"command", "capsoc bench cpu"}, {"tables", {{{"rows", rows}}}}}).sentence;
  };
  EXPECT_EQ(sentence("failed", "good"), "p failed");
  EXPECT_EQ(sentence("differs", "good"), "p prints another result than QEMU");
  EXPECT_EQ(sentence("good", "too slow"), "Too slow: 0.50 of QEMU with -icount");
  EXPECT_EQ(sentence("no QEMU", "good"),
            "The translator executes 123 million instructions a second. QEMU did not run");
}

}  // namespace
}  // namespace capsoc::report
