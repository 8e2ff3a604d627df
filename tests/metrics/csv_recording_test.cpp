#include "metrics/csv_recording.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "metrics/begin_recording.h"

namespace capsoc::metrics {
namespace {

namespace fs = std::filesystem;

class CsvRecordingTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::TempDir() + std::to_string(getpid()) + "csv_recording_test";
    fs::remove_all(folder_);
    fs::create_directory(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::unique_ptr<SampleWriter> begin(const std::string& columns) {
    auto writer = begin_recording({path(), "a test", record_columns(columns, "test").value()});
    EXPECT_TRUE(writer);
    return std::move(writer.value());
  }
  std::string path() const { return folder_ + "/r.csv"; }
  std::string contents() const {
    std::ifstream file(path(), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  long files() const {
    return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
  }

  std::string folder_;
};

RecordedSample sample(int k, bool has_truth) {
  return {k * 0.25, k << 28, -(k << 28), k * 0.125, has_truth};
}

TEST_F(CsvRecordingTest, ItGrowsBesideItsNameAndReplacesWhatWasThere) {
  std::ofstream(path()) << "old";
  auto writer = begin("");
  writer->add(sample(1, true));
  writer->add(sample(2, true));
  EXPECT_EQ(contents(), "old");
  EXPECT_EQ(files(), 2);
  EXPECT_FALSE(writer->finish());
  EXPECT_EQ(contents(), "# a test\nt,u,v,angle_deg\n0.25,0.125,-0.125,45\n0.5,0.25,-0.25,90\n");
  EXPECT_EQ(files(), 1);
}

TEST_F(CsvRecordingTest, WithoutAnEndNothingIsLeft) {
  begin("")->add(sample(1, true));
  EXPECT_EQ(files(), 0);
}

TEST_F(CsvRecordingTest, NoSamplesAreAHeading) {
  EXPECT_FALSE(begin("sample,angle_deg")->finish());
  EXPECT_EQ(contents(), "# a test\nsample,angle_deg\n");
}

TEST_F(CsvRecordingTest, TheAngleIsLeftOutUnlessAllSamplesHaveIt) {
  for (const bool first : {true, false}) {
    for (const auto& [columns, expected] :
         {std::pair("t,u,angle_deg", "# a test\nt,u\n0.25,0.125\n0.5,0.25\n"),
          std::pair("angle_deg,t,u", "# a test\nt,u\n0.25,0.125\n0.5,0.25\n"),
          std::pair("t,angle_deg,u", "# a test\nt,u\n0.25,0.125\n0.5,0.25\n"),
          std::pair("t,found_deg,angle_deg,error_deg",
                    "# a test\nt,found_deg,error_deg\n0.25,,\n0.5,,\n"),
          std::pair("t,u", "# a test\nt,u\n0.25,0.125\n0.5,0.25\n")}) {
      auto writer = begin(columns);
      writer->add(sample(1, first));
      writer->add(sample(2, !first));
      EXPECT_FALSE(writer->finish());
      EXPECT_EQ(contents(), expected) << columns;
    }
  }
}

TEST_F(CsvRecordingTest, ALongOneIsCutPieceByPiece) {
  constexpr int count = 20000;  // several pieces of the file
  auto writer = begin("sample,angle_deg,t");
  std::string expected = "# a test\nsample,t\n";
  for (int k = 0; k < count; ++k) {
    writer->add(sample(k, k + 1 < count));
    expected += std::to_string(k) + "," + fmt::format("{}", k * 0.25) + "\n";
  }
  EXPECT_FALSE(writer->finish());
  EXPECT_EQ(contents(), expected);
}

TEST_F(CsvRecordingTest, AFullDiskIsToldInTheEndAndTheOldFileStays) {
  std::ofstream(path()) << "old";
  auto writer = begin("");
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  rlimit small = before;
  small.rlim_cur = 10000;
  std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  for (int k = 0; k < 10000; ++k) writer->add(sample(1, true));
  const auto error = writer->finish();
  setrlimit(RLIMIT_FSIZE, &before);
  writer.reset();
  ASSERT_TRUE(error);
  EXPECT_NE(error->text.find("cannot be written (File too large)"), std::string::npos);
  EXPECT_EQ(contents(), "old");
  EXPECT_EQ(files(), 1);
}

TEST_F(CsvRecordingTest, WhatCannotBeWrittenIsSaidAtOnce) {
  const auto writer = begin_recording({folder_ + "/none/r.csv", "a test", {0}});
  ASSERT_FALSE(writer);
  EXPECT_NE(writer.error().find("none/r.csv: cannot be written"), std::string::npos);
}

TEST_F(CsvRecordingTest, APipeGetsItAtTheEnd) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  auto writer = begin_recording(
      {"/dev/fd/" + std::to_string(ends[1]), "a test", record_columns("t", "test").value()});
  ASSERT_TRUE(writer) << writer.error();
  writer.value()->add(sample(1, true));
  EXPECT_FALSE(writer.value()->finish());
  close(ends[1]);
  char text[64] = {};
  EXPECT_EQ(read(ends[0], text, sizeof text), 16);
  EXPECT_STREQ(text, "# a test\nt\n0.25\n");
  close(ends[0]);
}

}  // namespace
}  // namespace capsoc::metrics
