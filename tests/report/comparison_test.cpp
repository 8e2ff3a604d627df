// Two results side by side: what counts as a difference, and how it is said.
#include "report/comparison.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "../fuzz/damage.h"
#include "report/figure.h"
#include "report/page.h"
#include "report/values.h"

namespace capsoc::report {
namespace {

Json a_run() {
  Json j = {{"command", "capsoc run"}, {"exit", {{"code", 0}, {"reason", "well"}}}};
  j["configuration"] = {{"coprocessor.arithmetic", "precise"}, {"cpu.executor", "translator"}};
  j["time"] = {{"simulated_s", 420.5}, {"wall_s", 0.4}};
  j["cpu"] = {{"instructions", 6188760}, {"mips", 14.5}};
  j["parameters"]["beta"] = {{"word", 42996255}, {"value", 0.0629}};
  j["angle_error_deg"] = {{"uncalibrated_max", 25.363720166172588}};
  j["verdict"] = {{"pass", true}, {"bound_deg", 5.867332220077515e-07}, {"samples", 10000}};
  j["inputs"] = {{{"role", "firmware"}, {"path", "a.elf"}, {"sha256", std::string(64, 'a')}},
                 {{"role", "sensor"}, {"path", "s.toml"}, {"sha256", std::string(64, 'b')}}};
  j["uart0"] = {{"text", "hello\nprecise arithmetic\n"}};
  j["curves"]["a1"] = {{"x", {0, 1, 2}}, {"y", {0.5, 0.6, nullptr}}};
  j["curves"]["a2"] = {{"x", {0, 1}}, {"y", {0.5, 0.6}}};
  j["curves"]["angle_error"] = {{"x", {0, 1}}, {"y", {8.0, 1e-7}}};
  j["curves"]["raw_error"] = {{"x", {0, 1}}, {"y", {8.0, 7.0}}};
  return j;
}

Comparison comparison_of(const Json& a, const Json& b) {
  return *compared({{"a.json", a}, {"b.json", b}});
}

const Compared* value_named(const ComparedPart& part, const std::string& name) {
  for (const Compared& value : part.different)
    if (value.name == name) return &value;
  return nullptr;
}

TEST(Comparison, OfTheSameResultCountsItsValues) {
  const Comparison same = comparison_of(a_run(), a_run());
  EXPECT_TRUE(same.is_same());
  EXPECT_EQ(same.sentence, "The two results are the same in all 20 values: pass, exit 0");
  EXPECT_EQ(same.style, std::string("good"));
  EXPECT_EQ(text_of(same), "A  a.json\nB  b.json\n" + same.sentence + ".\n");
}

TEST(Comparison, TimesOfTheHostAreNoDifference) {
  Json other = a_run();
  other["time"]["wall_s"] = 1e9;
  other["cpu"]["mips"] = -1;
  EXPECT_TRUE(comparison_of(a_run(), other).is_same());
  EXPECT_TRUE(comparison_of({{"command", "capsoc campaign"}, {"wall_s", 1}},
                            {{"command", "capsoc campaign"}, {"wall_s", 2}})
                  .is_same());
}

TEST(Comparison, SaysFirstWhetherTheAnswersAgree) {
  Json other = a_run();
  other["verdict"]["bound_deg"] = 0.00205;
  other["configuration"]["coprocessor.arithmetic"] = "paper";
  const Comparison agree = comparison_of(a_run(), other);
  EXPECT_EQ(agree.sentence,
            "The answers agree: pass, exit 0; the bound is 5.87e-07 deg in A and 0.00205 deg in B. "
            "1 of 9 settings and 1 of 11 values differ");
  EXPECT_EQ(agree.style, std::string("good"));
  other = a_run();
  other["verdict"]["conditions"] = {"no sample is stale"};
  EXPECT_NE(comparison_of(a_run(), other).sentence.find("; under other conditions in A than in B."),
            std::string::npos);
  other = a_run();
  other["verdict"] = {{"pass", false}, {"reason", "no lock"}};
  other["exit"]["code"] = 1;
  const Comparison differ = comparison_of(a_run(), other);
  EXPECT_EQ(differ.sentence.substr(0, 77),
            "The answers differ: pass, exit 0 in A, no pass, exit 1 in B. 0 of 9 settings ");
  EXPECT_EQ(differ.style, std::string("bad"));
  Json same_bound = a_run();
  same_bound["cpu"]["instructions"] = 7;
  EXPECT_NE(
      comparison_of(a_run(), same_bound).sentence.find("; the bound is 5.87e-07 deg in both."),
      std::string::npos);
}

TEST(Comparison, NumbersHaveUnitsAndBothDifferences) {
  Json other = a_run();
  other["parameters"]["beta"] = {{"word", 42998214}, {"value", 0.0629029}};
  other["angle_error_deg"]["uncalibrated_max"] = 2536.3720166172588;
  other["time"]["simulated_s"] = 420.50001;
  const ComparedPart values = comparison_of(a_run(), other).values;
  ASSERT_EQ(values.different.size(), 4U);
  const Compared* const word = value_named(values, "parameters.beta.word");
  ASSERT_NE(word, nullptr);
  EXPECT_EQ(word->a + " " + word->b + " " + word->absolute + " " + word->relative + word->unit,
            "42996255 42998214 +1959 +0.00456 %");
  const Compared* const value = value_named(values, "parameters.beta.value");
  ASSERT_NE(value, nullptr);
  EXPECT_EQ(value->a + " " + value->b + " " + value->absolute + " " + value->unit,
            "0.0629 0.062903 +2.9e-06 rad");
  const Compared* const error = value_named(values, "angle_error_deg.uncalibrated_max");
  ASSERT_NE(error, nullptr);
  EXPECT_EQ(error->a + " " + error->b + " " + error->relative + " " + error->unit,
            "25.4 2536 x 100 deg");
  EXPECT_EQ(error->exact_a, "25.363720166172588");
  const Compared* const time = value_named(values, "time.simulated_s");
  ASSERT_NE(time, nullptr);
  EXPECT_EQ(time->a + " " + time->b + " " + time->unit, "420.5 420.50001 s");
}

TEST(Comparison, TextsAreCutToWhatTellsThemApart) {
  Json other = a_run();
  other["uart0"]["text"] = "hello\npaper arithmetic\n";
  other["inputs"][0]["path"] = std::string(80, 'x') + "/old/" + std::string(80, 'y');
  Json one = a_run();
  one["inputs"][0]["path"] = std::string(80, 'x') + "/new/" + std::string(80, 'y');
  other["inputs"][1]["sha256"] = std::string(64, 'c');
  const Comparison c = comparison_of(one, other);
  const Compared* const text = value_named(c.values, "uart0.text");
  ASSERT_NE(text, nullptr);
  EXPECT_EQ(text->a + "|" + text->b, "line 2: precise arithmetic|line 2: paper arithmetic");
  const Compared* const path = value_named(c.settings, "inputs.firmware.path");
  ASSERT_NE(path, nullptr);
  EXPECT_EQ(path->b.substr(0, 30), "..." + std::string(19, 'x') + "/old/yyy");
  EXPECT_EQ(path->exact_b.size(), 165U);
  const Compared* const sum = value_named(c.settings, "inputs.sensor.sha256");
  ASSERT_NE(sum, nullptr);
  EXPECT_EQ(sum->a + sum->b, "bbbbbbbbbbbbcccccccccccc");
  EXPECT_EQ(sum->exact_b, std::string(64, 'c'));
}

TEST(Comparison, ElementsAreFoundByWhatTheyAreCalled) {
  const auto result = [](const Json& rows) {
    return Json{{"command", "capsoc bench cpu"}, {"tables", {{{"id", "cpu"}, {"rows", rows}}}}};
  };
  const Json crc = {{"program", "crc"}, {"cpi", 1.5}}, aes = {{"program", "aes"}, {"cpi", 2}};
  EXPECT_TRUE(comparison_of(result({crc, aes}), result({aes, crc})).is_same());
  EXPECT_TRUE(comparison_of(result({crc, crc, aes}), result({crc, aes, crc})).is_same());
  const Comparison more = comparison_of(result(Json::array({aes})), result({crc, aes}));
  ASSERT_EQ(more.values.different.size(), 1U);
  const Compared& missing = more.values.different.front();
  EXPECT_EQ(missing.name + ": " + missing.a + ", " + missing.b, "tables.cpu.rows.crc: -, 2 values");
  EXPECT_EQ(more.values.different_count(), 2U);
}

TEST(Comparison, ARunOfACampaignGoesByItsNumberAndCountsHaveNoUnit) {
  const auto result = [](int run, int count) {
    return Json{{"command", "capsoc campaign"},
                {"worst", {{{"run", run}, {"exit", "0: well"}, {"worst", 2}}}},
                {"metrics", {{{"name", "convergence_s"}, {"count", count}, {"least", count}}}}};
  };
  const Comparison c = comparison_of(result(3, 4), result(5, 0));
  ASSERT_EQ(c.values.different.size(), 4U);
  EXPECT_EQ(c.values.different[0].name + ": " + c.values.different[0].a, "worst.run 3: 3 values");
  EXPECT_EQ(c.values.different[1].name + c.values.different[1].unit, "metrics.convergence_s.count");
  EXPECT_EQ(c.values.different[2].name + " " + c.values.different[2].unit,
            "metrics.convergence_s.least s");
  EXPECT_EQ(c.values.different[1].relative, "-100 %");
}

TEST(Comparison, NullIsWhatIsNotThere) {
  const auto result = [](const Json& summary) {
    return Json{{"command", "capsoc campaign"}, {"summary", summary}};
  };
  const Comparison c = comparison_of(result({{"mean", 1}}), result(nullptr));
  ASSERT_EQ(c.values.different.size(), 1U);
  EXPECT_EQ(c.values.different[0].name + ": " + c.values.different[0].a, "summary.mean: 1");
}

TEST(Comparison, OfAListTellsHowManyValues) {
  const auto result = [](const Json& list) {
    return Json{{"command", "capsoc campaign"}, {"sample", {{"runs", list}}}};
  };
  const Comparison c = comparison_of(result({1, 2, 3, 4, 5}), result({1, 2, 3, 4, 6}));
  ASSERT_EQ(c.values.different.size(), 1U);
  EXPECT_EQ(c.values.different[0].a + " / " + c.values.different[0].b,
            "5 entries / 5 entries, others");
  const Comparison few = comparison_of(result({0.5716504419378943, 1}), result({0.25, "x"}));
  ASSERT_EQ(few.values.different.size(), 1U);
  EXPECT_EQ(few.values.different[0].a + " / " + few.values.different[0].b,
            "[0.57165, 1] / [0.25, x]");
  EXPECT_EQ(few.values.different[0].exact_a, "[0.5716504419378943,1]");
}

TEST(Comparison, PlotsShareTheirPlacesInTwoColours) {
  Json other = a_run();
  other["curves"]["a1"]["y"][1] = 0.7;
  other["curves"]["angle_error"]["y"][1] = 1e-4;
  const std::vector<ResultFile> results = {{"a.json", a_run()}, {"b.json", other}};
  const Comparison c = *compared(results);
  EXPECT_EQ(c.different_plots, (std::vector<std::string>{"a1", "angle-error"}));
  EXPECT_EQ(c.same_plots, (std::vector<std::string>{"a2"}));
  const Data data = data_of(*figure_named("angle-error"), results);
  ASSERT_EQ(data.series.size(), 4U);
  std::vector<std::size_t> colours, variants;
  for (std::size_t i = 0; i < data.series.size(); ++i) {
    colours.push_back(colour_of(data, i));
    variants.push_back(data.series[i].variant);
  }
  EXPECT_EQ(colours, (std::vector<std::size_t>{0, 0, 1, 1}));
  EXPECT_EQ(variants, (std::vector<std::size_t>{0, 1, 0, 1}));
  const std::string page = page_of(results);
  const auto count = [&](const std::string& text) {
    std::size_t times = 0;
    for (std::size_t at = page.find(text); at != std::string::npos; at = page.find(text, at + 1))
      ++times;
    return times;
  };
  EXPECT_EQ(count("data-figure=\"angle-error\""), 1U);
  EXPECT_EQ(count("data-figure=\"a1\""), 1U);
  EXPECT_EQ(count("data-figure=\"a2\""), 0U);
  EXPECT_LT(page.find("data-figure=\"angle-error\""), page.find("data-figure=\"a1\""));
  EXPECT_EQ(count("The same in both: 9 settings, 11 values and 1 plot"), 1U);
  EXPECT_EQ(page, page_of(results));
}

TEST(Comparison, BarsArePairedByTheirLabels) {
  const auto result = [](const std::vector<std::pair<std::string, double>>& rows) {
    Json j = {{"command", "capsoc accuracy"}, {"tables", {{{"id", "widths"}}}}};
    for (const auto& [name, error] : rows)
      j["tables"][0]["rows"].push_back({{"quantity", name}, {"precise", error}});
    return j;
  };
  const auto data = [&](const Json& a, const Json& b) {
    return data_of(*figure_named("accuracy-widths"), {{"a", a}, {"b", b}});
  };
  using Numbers = std::vector<double>;
  const Data words = data(result({{"x", 1}, {"y", 2}, {"y", 3}}), result({{"z", 4}, {"y", 5}}));
  EXPECT_EQ(words.labels, (std::vector<std::string>{"x", "y", "y", "z"}));
  EXPECT_EQ(words.series[0].curve.x, (Numbers{0, 1, 2}));
  EXPECT_EQ(words.series[1].curve.x, (Numbers{3, 1}));
  const Data numbers = data(result({{"12", 1}, {"24", 2}}), result({{"8", 3}, {"16", 4}}));
  EXPECT_EQ(numbers.labels, (std::vector<std::string>{"8", "12", "16", "24"}));
  EXPECT_EQ(numbers.series[0].curve.x, (Numbers{1, 3}));
  EXPECT_EQ(numbers.series[1].curve.x, (Numbers{0, 2}));
}

TEST(Comparison, NeedsTwoResultsOfOneCommand) {
  const ResultFile run = {"a", a_run()}, fit = {"b", {{"command", "capsoc fit x"}}};
  EXPECT_EQ(reason_not_compared({run, run}), "");
  EXPECT_EQ(reason_not_compared({run, fit}),
            "two results of one command are compared, and here is one of run and one of fit");
  EXPECT_EQ(reason_not_compared({run, run, run}), "two results are compared, and here are 3");
  EXPECT_FALSE(compared({run, fit}));
  EXPECT_FALSE(compared({run}));
}

TEST(Comparison, SaysTheSameInTextAndPage) {
  Json other = a_run();
  other["parameters"]["beta"]["word"] = 42998214;
  other["cpu"]["instructions"] = 6190972;
  const std::vector<ResultFile> results = {{"a.json", a_run()}, {"b.json", other}};
  const std::string text = text_of(*compared(results)), page = page_of(results);
  for (const char* words :
       {"The answers agree: pass, exit 0; the bound is 5.87e-07 deg in both. 0 of 9 settings and 2 "
        "of "
        "11 values differ.",
        "values that differ: 2 of 6", "parameters.beta.word", "42998214", "+1959", "+0.00456 %",
        "The same in both: 9 settings, 9 values and 3 plots"}) {
    EXPECT_NE(text.find(words), std::string::npos) << words << "\n" << text;
    EXPECT_NE(page.find(words), std::string::npos) << words;
  }
}

TEST(Comparison, OfDamagedResultsHasNoControlCharacters) {
  const Json whole = a_run();
  Json strange = whole;
  strange["exit"]["reason"] = "\x1b]0;title\x07";
  strange["exit"]["\x1b[31m"] = "\x1b[0m";
  strange["configuration"]["cpu.executor"] = {{"unit", "\x1b[1m"}, {"n", 1}};
  strange["uart0"]["text"] = "hello\npre\x1b[31mcise";
  const std::string text = strange.dump(2);
  uint64_t compared_files = 0;
  const uint64_t count = test::file_count(1000);
  for (uint64_t number = 0; number < count; ++number) {
    test::Damage damage(number);
    const Json json = Json::parse(damage.text(text), nullptr, false);
    if (json.is_discarded() || command_of(json) != "run") continue;
    ++compared_files;
    const std::string said = text_of(comparison_of(whole, json));
    EXPECT_TRUE(std::all_of(said.begin(), said.end(), [](char c) {
      return static_cast<unsigned char>(c) >= 0x20 || c == '\n';
    })) << number;
    EXPECT_GT(page_of({{"a", whole}, {"b", json}}).size(), 1000U) << number;
  }
  EXPECT_GT(compared_files, count / 50);
}

TEST(Values, MatchPatternsOfKeys) {
  EXPECT_TRUE(matches({"exit", "code"}, "exit"));
  EXPECT_TRUE(matches({"tables", "1", "rows", "a", "verdict"}, "tables.*.rows.*.verdict"));
  EXPECT_FALSE(matches({"tables", "1", "rows", "a", "here"}, "tables.*.rows.*.verdict"));
  EXPECT_FALSE(matches({"exit"}, "exit.code"));
  EXPECT_TRUE(matches({"configuration", "firmware.elf"}, "configuration"));
}

}  // namespace
}  // namespace capsoc::report
