#include "reproduce/reproduce.h"

#include <gtest/gtest.h>

#include <sstream>

#include "reproduce/lms_experiment.h"
#include "reproduce/report.h"

namespace capsoc::reproduce {
namespace {

TEST(Reproduce, EveryRowThatShouldAgreeWithThePaperDoes) {
  std::ostringstream out;
  EXPECT_EQ(reproduce_tables(out, "traces"), 0) << out.str();
}

TEST(Reproduce, PrintsEveryTable) {
  std::ostringstream out;
  reproduce_tables(out, "traces");
  for (const int table : {1, 2, 3, 4, 5, 6, 8, 9, 10}) {
    EXPECT_NE(out.str().find("Table " + std::to_string(table)), std::string::npos) << table;
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
  report.row("x", "1.0", "2.0", false);
  report.row("y", "1.0", "1.0", true);
  report.known("z", "1.0", "3.0", "a reason.");
  EXPECT_EQ(report.unexpected(), 1);
  EXPECT_NE(out.str().find("DIFFERS"), std::string::npos);
  EXPECT_NE(out.str().find("differs: a reason."), std::string::npos);
}

TEST(Report, TextAndDataAreTheSameRows) {
  std::ostringstream out;
  Report report(out, {"8"});
  report.heading("1");
  report.row("left out", "1.0", "2.0", false);
  report.heading("8");
  Spread spread;
  spread.add(1.5);
  spread.add(2.5);
  report.row("ratio, %", fixed(2.0, 1), spread.figure(1), spread.admits(2.0, 1));
  report.known("time", "3.50 s", "never", "a reason.");
  EXPECT_EQ(report.unexpected(), 0);
  EXPECT_EQ(out.str().find("left out"), std::string::npos);
  EXPECT_NE(out.str().find("ratio, %"), std::string::npos);
  EXPECT_NE(out.str().find("1.5 .. 2.5  agrees"), std::string::npos) << out.str();
  ASSERT_EQ(report.tables().size(), 1U);
  EXPECT_EQ(to_csv(report.tables()),
            "table,quantity,unit,paper,paper_value,here,here_least,here_greatest,tolerance,verdict,"
            "note\n"
            "8,ratio,%,2.0,2,1.5 .. 2.5,1.5,2.5,0.55,agrees,\n"
            "8,time,s,3.50 s,3.5,never,,,,known,a reason.\n");
  const auto json = to_json(report.tables());
  EXPECT_EQ(json["tables"][0]["id"], "8");
  EXPECT_EQ(json["tables"][0]["rows"][1]["here_least"], nullptr);
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
  EXPECT_TRUE(agrees(30.383, 30.38, 2));
  EXPECT_FALSE(agrees(30.386, 30.38, 2));
}

}  // namespace
}  // namespace capsoc::reproduce
