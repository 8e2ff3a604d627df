#include "trace/coverage_file.h"

#include <gtest/gtest.h>

namespace capsoc::trace {
namespace {

ProgramCoverage example() {
  ProgramCoverage coverage;
  coverage.program = "capsoc_1";
  FileCoverage& file = coverage.files["src/main.c"];
  file.functions["main"] = {3, 1};
  file.functions["operator,"] = {9, 0};
  file.lines = {{3, 1}, {4, 17}, {9, 0}};
  file.decisions[{4, 0}] = {16, 1};
  file.decisions[{9, 0}] = {0, 0};
  return coverage;
}

constexpr const char* example_text =
    "TN:capsoc_1\nSF:src/main.c\nFN:3,main\nFN:9,operator,\nFNDA:1,main\nFNDA:0,operator,\nFNF:2\n"
    "FNH:1\nBRDA:4,0,0,16\nBRDA:4,0,1,1\nBRDA:9,0,0,-\nBRDA:9,0,1,-\nBRF:4\nBRH:2\nDA:3,1\nDA:4,"
    "17\n"
    "DA:9,0\nLF:3\nLH:2\nend_of_record\n";

TEST(CoverageFile, IsWhatLcovReads) {
  EXPECT_EQ(to_lcov(example()), example_text);
}

TEST(CoverageFile, IsReadBackAsItWas) {
  const auto read = parse_lcov("x.info", example_text);
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(to_lcov(read.value()), example_text);
}

TEST(CoverageFile, RunsAreAddedUpToTheEndOfTheNumbers) {
  ProgramCoverage sum = example();
  sum.files["src/main.c"].lines[4] = UINT64_MAX - 5;
  sum.add(example());
  EXPECT_EQ(sum.files["src/main.c"].lines[3], 2u);
  EXPECT_EQ(sum.files["src/main.c"].lines[4], UINT64_MAX);
  EXPECT_EQ(sum.files["src/main.c"].functions["main"].calls, 2u);
  EXPECT_EQ(sum.files["src/main.c"].functions["main"].line, 3u);
  EXPECT_EQ((sum.files["src/main.c"].decisions[{4, 0}].yes), 32u);
}

TEST(CoverageFile, DamageIsOneSentenceWithTheLine) {
  const auto read = parse_lcov("x.info", "TN:capsoc_1\nSF:a.c\nDA:1,2\nDA:1,3\nend_of_record\n");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().rfind("x.info:4: ", 0), 0u) << read.error();
}

}  // namespace
}  // namespace capsoc::trace
