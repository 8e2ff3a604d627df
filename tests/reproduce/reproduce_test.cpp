#include "reproduce/reproduce.h"

#include <gtest/gtest.h>

#include <sstream>

#include "reproduce/lms_experiment.h"
#include "reproduce/report.h"

namespace capsoc::reproduce {
namespace {

/// Without a bound only what the papers draw and do not print.
bool bound_and_verdict_go_together(const Fields& row) {
  bool bounded = false, judged = false;
  for (const auto& [name, value] : row) {
    if (name == "verdict") judged = !std::get<std::string>(value).empty();
    if (name == "bound_least" || name == "bound_greatest")
      bounded = bounded || std::holds_alternative<double>(value);
  }
  return bounded == judged;
}

TEST(Reproduce, EveryRowIsInItsBoundAndHasOne) {
  std::ostringstream out;
  std::vector<DataTable> tables;
  EXPECT_EQ(reproduce_tables(out, "traces", {}, &tables), 0) << out.str();
  ASSERT_EQ(tables.size(), table_names().size());
  for (std::size_t i = 0; i < tables.size(); ++i) {
    EXPECT_EQ(tables[i].id, table_names()[i].first);
    EXPECT_NE(out.str().find(tables[i].title), std::string::npos);
    EXPECT_FALSE(tables[i].rows.empty()) << tables[i].id;
    for (const Fields& row : tables[i].rows)
      EXPECT_TRUE(bound_and_verdict_go_together(row))
          << tables[i].id << ": " << std::get<std::string>(row.front().second);
  }
}

TEST(Reproduce, GivesThePapersTwoHeadlineErrors) {
  Experiment experiment;
  experiment.steps = {{3e-4, 3e-4, 3e-4}, {5e-4, 3e-4, 1e-4}};
  const Outcome outcome = run(experiment);
  EXPECT_NEAR(outcome.uncalibrated, 30.383, 5e-4);
  EXPECT_NEAR(outcome.uncalibrated_to_truth, 25.364, 5e-4);
  EXPECT_NEAR(outcome.calibrated, 9.523e-4, 5e-8);
}

TEST(Report, CountsRowsThatShouldAgreeAndDoNot) {
  std::ostringstream out;
  Report report(out);
  report.row("x", "1.0", "2.0", agrees(2.0, 1.0, 1));
  report.row("y", "1.0", "1.0", agrees(1.0, 1.0, 1));
  report.known("z", "1.0", "3.0", {2.5, 3.5}, "a reason.");
  EXPECT_EQ(report.unexpected(), 1);
  EXPECT_NE(out.str().find("DIFFERS, and should not: agrees within 0.05\n"), std::string::npos);
  EXPECT_NE(out.str().find("1.0  agrees within 0.05\n"), std::string::npos);
  EXPECT_NE(out.str().find("differs (2.5 .. 3.5): a reason."), std::string::npos);
}

TEST(Report, CountsAKnownDifferenceThatIsNoLongerTheKnownOne) {
  std::ostringstream out;
  Report report(out);
  report.known("z", "1.0", "3.0", {3.1, 3.5}, "a reason.");
  EXPECT_EQ(report.unexpected(), 1);
  EXPECT_NE(out.str().find("OUT OF ITS BOUND (3.1 .. 3.5): a reason."), std::string::npos);
  report.known("time", "3.50 s", "never", Bound::at_most(4), "a reason.");
  EXPECT_EQ(report.unexpected(), 2) << "no number lies in no bound";
}

TEST(Report, CountsAFigureOfOursThatMissesItsBound) {
  std::ostringstream out;
  Report report(out);
  report.ours("x", "0.5", Bound::at_most(1));
  report.point("y", "7");
  EXPECT_EQ(report.unexpected(), 0);
  EXPECT_NE(out.str().find("0.5  holds (at most 1)\n"), std::string::npos) << out.str();
  EXPECT_NE(out.str().find("7\n"), std::string::npos);
  report.ours("x", "1.5", Bound::at_most(1));
  EXPECT_EQ(report.unexpected(), 1);
}

TEST(Report, TextAndDataAreTheSameRows) {
  std::ostringstream out;
  Report report(out, {"8"});
  report.heading("1");
  report.row("left out", "1.0", "2.0", agrees(2.0, 1.0, 1));
  report.heading("8");
  Spread spread;
  spread.add(1.5);
  spread.add(2.5);
  report.row("ratio, %", fixed(2.0, 1), spread.figure(1), spread.admits(2.0, 1));
  report.known("time", "3.50 s", "4.00 s", {3.75, 4.25}, "a reason.");
  EXPECT_EQ(report.unexpected(), 0);
  EXPECT_EQ(out.str().find("left out"), std::string::npos);
  EXPECT_NE(out.str().find("ratio, %"), std::string::npos);
  EXPECT_NE(out.str().find("1.5 .. 2.5  agrees within 0.55 of the range\n"), std::string::npos)
      << out.str();
  ASSERT_EQ(report.tables().size(), 1U);
  EXPECT_EQ(to_csv(report.tables()),
            "table,quantity,unit,paper,paper_value,here,here_least,here_greatest,tolerance,"
            "bound_least,bound_greatest,verdict,note\n"
            "8,ratio,%,2.0,2,1.5 .. 2.5,1.5,2.5,0.55,1.45,2.55,agrees,\n"
            "8,time,s,3.50 s,3.5,4.00 s,4,4,,3.75,4.25,known,a reason.\n");
  const auto json = to_json(report.tables());
  EXPECT_EQ(json["tables"][0]["id"], "8");
  EXPECT_EQ(json["tables"][0]["rows"][1]["tolerance"], nullptr);
  EXPECT_EQ(json["tables"][0]["rows"][0]["tolerance"], 0.55);
}

TEST(Report, AnExperimentThatCannotBeMadeIsToldWhateverWasChosen) {
  std::ostringstream out;
  Report report(out, {"9"});
  report.heading("1");
  report.failure("trace.toml", "is gone");
  EXPECT_EQ(report.unexpected(), 1);
  EXPECT_NE(out.str().find("is gone"), std::string::npos);
}

TEST(DataTable, TextsThatWouldBreakALineAreQuoted) {
  const std::vector<DataTable> tables = {
      {"t", "T", {{{"a", std::string("x, \"y\"\nz")}, {"b", 0.1}, {"c", Field()}}}}};
  EXPECT_EQ(to_csv(tables), "table,a,b,c\nt,\"x, \"\"y\"\"\nz\",0.1,\n");
}

TEST(Report, ASpreadAdmitsAnotherSeedButNotAnotherExperiment) {
  Spread spread;
  for (const double value : {0.590, 0.586, 0.594}) spread.add(value);
  EXPECT_EQ(spread.text(3), "0.586 .. 0.594");
  EXPECT_TRUE(spread.admits(0.583, 3));
  EXPECT_FALSE(spread.admits(0.579, 3));
  EXPECT_FALSE(spread.admits(0.583, 3, 0));
  EXPECT_TRUE(agrees(30.383, 30.38, 2));
  EXPECT_FALSE(agrees(30.386, 30.38, 2));
}

}  // namespace
}  // namespace capsoc::reproduce
