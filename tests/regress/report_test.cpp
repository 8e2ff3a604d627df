#include "regress/report.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>

namespace capsoc::regress {
namespace {

using coprocessor::Arithmetic;

Outcome outcome_with_difference() {
  Outcome outcome;
  outcome.coverage.emplace_back(Arithmetic::precise, Coverage(Arithmetic::precise));
  for (uint64_t seed : {7u, 8u}) {
    Run run;
    run.scenario = &scenarios().back();
    run.seed = seed;
    run.command = "capsoc regress --again";
    run.done = true;
    outcome.runs.push_back(run);
  }
  outcome.runs[1].finding = Finding{Finding::Kind::difference,
                                    1234,
                                    "read of <FLAGS> & \"more\"",
                                    "sine (T2)",
                                    "line\x01\n",
                                    0,
                                    {}};
  return outcome;
}

// Enough of XML for what we write: every tag is closed in order, no stray characters.
::testing::AssertionResult well_formed(const std::string& text) {
  std::vector<std::string> open;
  for (size_t i = 0; i < text.size(); ++i) {
    if (static_cast<unsigned char>(text[i]) < 0x20 && text[i] != '\n' && text[i] != '\t')
      return ::testing::AssertionFailure() << "control character";
    if (text[i] == '>') return ::testing::AssertionFailure() << "stray >";
    if (text[i] != '<') continue;
    bool quoted = false;
    size_t end = i + 1;
    for (; end < text.size() && (quoted || text[end] != '>'); ++end) {
      if (text[end] == '"') quoted = !quoted;
      if (quoted && text[end] == '<') return ::testing::AssertionFailure() << "< in an attribute";
    }
    const std::string tag = text.substr(i + 1, end - i - 1);
    i = end;
    if (tag.empty() || tag[0] == '?' || tag.back() == '/') continue;
    const std::string name = tag.substr(0, tag.find(' '));
    if (name[0] != '/') {
      open.push_back(name);
    } else if (open.empty() || open.back() != name.substr(1)) {
      return ::testing::AssertionFailure() << name << " closes nothing";
    } else {
      open.pop_back();
    }
  }
  if (!open.empty()) return ::testing::AssertionFailure() << open.back() << " is left open";
  return ::testing::AssertionSuccess();
}

TEST(JUnit, IsWellFormedAndCountsFailures) {
  const std::string text = to_junit(outcome_with_difference());
  EXPECT_TRUE(well_formed(text)) << text;
  EXPECT_NE(text.find("tests=\"2\" failures=\"1\""), std::string::npos) << text;
  EXPECT_NE(text.find("&lt;FLAGS&gt; &amp; &quot;more&quot;"), std::string::npos) << text;
}

TEST(JUnit, HasTimesAttachmentsAndWhatIsNotDone) {
  Outcome outcome = outcome_with_difference();
  outcome.runs[0].wall_s = 1.25;
  outcome.runs[1].has_waves = true;
  outcome.runs[1].waves_file = "/waves/<a>";
  outcome.runs.push_back(outcome.runs[0]);
  outcome.runs.back().finding = Finding{Finding::Kind::no_result, 0, "out of time", "", "", 0, {}};
  outcome.runs.push_back(outcome.runs[0]);
  outcome.runs.back().done = false;
  const std::string text = to_junit(outcome);
  EXPECT_TRUE(well_formed(text)) << text;
  for (const char* part :
       {"tests=\"4\" failures=\"1\" errors=\"1\" skipped=\"1\" time=\"3.750\"",
        "seed 7\" time=\"1.250\"/>",
        "[[ATTACHMENT|/waves/&lt;a&gt;.fst]]\n[[ATTACHMENT|/waves/&lt;a",
        "waves: gtkwave '/waves/&lt;a&gt;.fst'", "<error message=\"out of time\">",
        "<skipped message=\"not done yet\"/>"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
}

TEST(Text, OfAPartSaysSo) {
  Outcome outcome = outcome_with_difference();
  outcome.runs[1].finding.reset();
  outcome.runs[1].done = false;
  const std::string text = to_text(Plan{}, outcome, {});
  EXPECT_NE(text.find("PARTIAL: 1 of 2 runs are done\nno difference until here\n"),
            std::string::npos)
      << text;
  EXPECT_EQ(text.find("missing:"), std::string::npos) << "runs that are not done say nothing";
  EXPECT_EQ(to_json(Plan{}, outcome, {})["partial"],
            nlohmann::ordered_json::parse(R"({"done": 1, "of": 2})"));
}

TEST(Text, SaysHowToSeeTheWaves) {
  Outcome outcome = outcome_with_difference();
  EXPECT_NE(to_text(Plan{}, outcome, {})
                .find("waves: capsoc regress --again --waves waves; gtkwave waves/"),
            std::string::npos);
  outcome.runs[1].has_waves = true;
  outcome.runs[1].waves_file = "here/x";
  EXPECT_NE(to_text(Plan{}, outcome, {}).find("waves: gtkwave here/x.fst here/x.gtkw\n"),
            std::string::npos);
}

TEST(Text, NamesTheDifferenceTheNodeAndTheCommand) {
  const std::string text = to_text(Plan{}, outcome_with_difference(), {});
  for (const char* part : {"seed 8", "cycle 1234", "sine (T2)", "again: capsoc regress --again"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
}

TEST(Text, NamesTheBinsThatWereNotReached) {
  Outcome outcome = outcome_with_difference();
  outcome.runs[1].finding.reset();
  const std::string text = to_text(Plan{}, outcome, {});
  EXPECT_NE(text.find("missing: seam: below half a turn"), std::string::npos) << text;
  EXPECT_NE(text.find("no difference"), std::string::npos) << text;
}

TEST(Json, HoldsRunsBinsAndWhatIsMissing) {
  const auto json = to_json(Plan{}, outcome_with_difference(), {});
  EXPECT_TRUE(json["difference"].get<bool>());
  const auto& part = json["arithmetics"]["precise"];
  EXPECT_EQ(part["runs"].size(), 2u);
  EXPECT_FALSE(part["runs"][0].contains("difference"));
  EXPECT_EQ(part["runs"][1]["difference"]["node"], "sine (T2)");
  EXPECT_EQ(part["coverage"]["seam"].size(), 4u);
  EXPECT_FALSE(part["missing"].empty());
}

class RtlCoverageFiles : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) {
    const std::string path = testing::TempDir() + "regress_" + name;
    std::ofstream(path) << text;
    paths_.push_back(path);
    return path;
  }
  static std::string point(const std::string& file, int line, const std::string& page,
                           const std::string& object, int hits) {
    return "C '\1f\2" + file + "\1l\2" + std::to_string(line) + "\1n\2" + "1\1page\2" + page +
           "\1o\2" + object + "\1h\2TOP.dut' " + std::to_string(hits) + "\n";
  }
  ~RtlCoverageFiles() override {
    for (const std::string& path : paths_) std::remove(path.c_str());
  }
  std::vector<std::string> paths_;
};

TEST_F(RtlCoverageFiles, AreAddedPointByPoint) {
  const auto a = write("a.dat", point("x/rtl/a.sv", 3, "v_line/a", "block", 1) +
                                    point("x/rtl/a.sv", 4, "v_branch/a", "if", 0) +
                                    point("x/rtl/a.sv", 5, "v_toggle/a", "q[0]", 0) +
                                    point("x/rtl/a.sv", 5, "v_toggle/a", "q[1]", 0) +
                                    point("x/rtl/a.sv", 5, "v_toggle/a", "q[31]", 0) +
                                    point("x/rtl/verification/p.sv", 5, "v_toggle/p", "z", 0));
  const auto b = write("b.dat", point("x/rtl/a.sv", 3, "v_line/a", "block", 0) +
                                    point("x/rtl/a.sv", 4, "v_branch/a", "if", 2) +
                                    point("x/rtl/a.sv", 5, "v_toggle/a", "q[0]", 0) +
                                    point("x/rtl/a.sv", 5, "v_toggle/a", "q[1]", 3) +
                                    point("x/rtl/a.sv", 5, "v_toggle/a", "q[31]", 0) +
                                    point("x/rtl/verification/p.sv", 5, "v_toggle/p", "z", 0));
  const auto list = write("list.txt", "# comment\ntoggle a.sv q[31:16] # upper half is constant\n");
  const auto exceptions = CoverageExceptions::read(list);
  ASSERT_TRUE(exceptions) << exceptions.error();
  const auto merged = merge_coverage("precise", {a, b}, write("sum.dat", ""), exceptions.value());
  ASSERT_TRUE(merged) << merged.error();
  const RtlCoverage::Kind& line = merged.value().kinds[0];
  const RtlCoverage::Kind& toggle = merged.value().kinds[1];
  EXPECT_EQ(line.points, 2u);
  EXPECT_EQ(line.covered, 2u);
  EXPECT_EQ(toggle.points, 3u);
  EXPECT_EQ(toggle.excepted, 1u);
  EXPECT_EQ(toggle.percent(), 50);
  EXPECT_DOUBLE_EQ(toggle.percent_of_all(), 100.0 / 3);
  ASSERT_EQ(toggle.missing.size(), 1u);
  EXPECT_EQ(toggle.missing[0], "a.sv:5 q[0] (TOP.dut)");
}

TEST_F(RtlCoverageFiles, AnExceptionOfOneArithmeticIsNoneOfTheOther) {
  const auto file = write("a.dat", point("x/rtl/a.sv", 4, "v_branch/a", "if", 0) +
                                       point("x/rtl/a.sv", 5, "v_toggle/a", "words[20][3]", 0) +
                                       point("x/rtl/a.sv", 5, "v_toggle/a", "words[21][3]", 0));
  const auto exceptions = CoverageExceptions::read(write(
      "list.txt", "paper line a.sv 4 # left out\nprecise toggle a.sv words[20:20] # unused\n"));
  ASSERT_TRUE(exceptions) << exceptions.error();
  const auto excepted = [&](const std::string& arithmetic, unsigned kind) {
    const auto merged =
        merge_coverage(arithmetic, {file}, write("sum.dat", ""), exceptions.value());
    return merged ? merged.value().kinds[kind].excepted : 99u;
  };
  EXPECT_EQ(excepted("paper", 0), 1u);
  EXPECT_EQ(excepted("precise", 0), 0u);
  EXPECT_EQ(excepted("paper", 1), 0u);
  EXPECT_EQ(excepted("precise", 1), 1u) << "of a memory the first index is the word";
}

TEST_F(RtlCoverageFiles, OneThatIsCutShortIsRefused) {
  const std::string first = point("x/rtl/a.sv", 3, "v_line/a", "block", 1);
  const auto whole = write("a.dat", first + point("x/rtl/a.sv", 4, "v_branch/a", "if", 0));
  const auto cut = write("b.dat", first);
  const auto exceptions = CoverageExceptions::read(write("list.txt", "# none\n"));
  ASSERT_TRUE(exceptions) << exceptions.error();
  for (const auto& files : {std::vector{whole, cut}, std::vector{cut, whole}}) {
    const auto merged = merge_coverage("precise", files, write("sum.dat", ""), exceptions.value());
    ASSERT_FALSE(merged);
    EXPECT_NE(merged.error().find("cut short"), std::string::npos) << merged.error();
  }
}

TEST_F(RtlCoverageFiles, AnExceptionWithoutAReasonIsRefused) {
  const auto exceptions = CoverageExceptions::read(write("bad.txt", "toggle a.sv q\n"));
  ASSERT_FALSE(exceptions);
  EXPECT_NE(exceptions.error().find("bad.txt:1"), std::string::npos) << exceptions.error();
}

}  // namespace
}  // namespace capsoc::regress
