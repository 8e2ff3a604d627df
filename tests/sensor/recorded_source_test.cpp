#include "sensor/recorded_source.h"

#include <gtest/gtest.h>

namespace capsoc::sensor {
namespace {

std::string error_of_record(const std::string& text) {
  const Result<RecordedSource> result = read_recording(text, "r.csv");
  return result ? "no error" : result.error();
}

TEST(RecordedSource, GivesTheRowsByColumnName) {
  Result<RecordedSource> result = read_recording(
      "# a comment\nt, v ,temperature,u,angle_deg\n0,0.5,20,-0.25,90\n0.5,1.05,x,+1e-3,-90\n",
      "dir/r.csv");
  ASSERT_TRUE(result) << result.error();
  RecordedSource& source = result.value();
  const SensorValue first = *source.sample(0, 0.0);
  EXPECT_EQ(first.u, -0.25);
  EXPECT_EQ(first.v, 0.5);
  EXPECT_TRUE(first.has_truth);
  EXPECT_EQ(first.angle_turns, 0.25);
  const SensorValue second = *source.sample(1, 99.0);
  EXPECT_EQ(second.u, 1e-3);
  EXPECT_EQ(second.v, 1.05);
  EXPECT_EQ(second.angle_turns, 0.75);
  EXPECT_FALSE(source.sample(2, 0.0));
  source.rewind();
  EXPECT_EQ(source.sample(0, 0.0)->u, -0.25);
  EXPECT_EQ(source.description().name, "r.csv");
  EXPECT_EQ(source.description().samples, 2u);
  EXPECT_EQ(source.description().sample_rate_hz, 2.0);
  EXPECT_EQ(source.description().motion, MotionKind::recorded);
  EXPECT_FALSE(source.description().a1);
}

TEST(RecordedSource, AcceptsWindowsLineEndsAMarkAndNoLastLineEnd) {
  Result<RecordedSource> result =
      read_recording("\xEF\xBB\xBFu,v\r\n0.1,0.2\r\n\r\n0.3,0.4", "r.csv");
  ASSERT_TRUE(result) << result.error();
  EXPECT_EQ(result.value().sample(1, 0.0)->v, 0.4);
  EXPECT_FALSE(result.value().sample(0, 0.0)->has_truth);
  EXPECT_FALSE(result.value().description().sample_rate_hz);
}

TEST(RecordedSource, SaysWhatIsWrongWithTheHeader) {
  EXPECT_EQ(error_of_record(""), "r.csv:1: the file is empty; it needs a header row with u and v");
  EXPECT_EQ(error_of_record("\n# x\n"),
            "r.csv:2: the file is empty; it needs a header row with u and v");
  EXPECT_EQ(
      error_of_record("u,w\n1,2\n"),
      "r.csv:1: the columns are 'u', 'w'; name those of the sine and the cosine with --columns "
      "U,V or --columns T,U,V,ANGLE (names, or numbers from 1)");
  EXPECT_EQ(error_of_record("u,v,u\n1,2,3\n"),
            "r.csv:1: column 'u' appears twice; keep one, or choose with --columns");
  EXPECT_EQ(error_of_record("u,v,angle_dg\n1,2,3\n"),
            "r.csv:1: column 'angle_dg' is not known; did you mean 'angle_deg'?");
  EXPECT_EQ(error_of_record("u,v\n"),
            "r.csv:1: there is no row after the header; a recording needs samples");
}

TEST(RecordedSource, SaysWhatIsWrongWithARow) {
  EXPECT_EQ(error_of_record("u,v\n1,2\n1\n"),
            "r.csv:3: the row has 1 columns and the header 2; complete or remove it");
  EXPECT_EQ(error_of_record("u,v\n1,2,3\n"),
            "r.csv:2: the row has 3 columns and the header 2; complete or remove it");
  EXPECT_EQ(error_of_record("u,v\n\n1,abc\n"),
            "r.csv:3: 'abc' in column 'v' is not a number; correct or remove the row");
  EXPECT_EQ(error_of_record("u,v\n1,\n"),
            "r.csv:2: '' in column 'v' is not a number; correct or remove the row");
  EXPECT_EQ(error_of_record("u,v\n1,1e999\n"),
            "r.csv:2: '1e999' in column 'v' is not a number; correct or remove the row");
  EXPECT_EQ(error_of_record("u,v\n1,+-2\n"),
            "r.csv:2: '+-2' in column 'v' is not a number; correct or remove the row");
  EXPECT_EQ(error_of_record("u,v\nnan,2\n"),
            "r.csv:2: 'nan' in column 'u' is not finite; remove the row");
  EXPECT_EQ(error_of_record("u,v\n1,-inf\n"),
            "r.csv:2: '-inf' in column 'v' is not finite; remove the row");
  EXPECT_EQ(error_of_record("u,v,t\n1,0,0.5\n1,0,0.7\n1,0,0.6\n"),
            "r.csv:4: t falls from 0.7 to 0.6; sort the rows by time");
  EXPECT_EQ(error_of_record(std::string("u,v\n1,\x1b[2J\n")),
            "r.csv:2: '?[2J' in column 'v' is not a number; correct or remove the row");
}

}  // namespace
}  // namespace capsoc::sensor
