#include "sensor/load.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace capsoc::sensor {
namespace {

std::string error_of_file(const std::string& path) {
  const Result<std::unique_ptr<Source>> result = load(path);
  return result ? "no error" : result.error();
}

TEST(Load, SaysThatAFileIsMissing) {
  EXPECT_EQ(
      error_of_file("traces/none.toml"),
      "traces/none.toml: cannot be read (No such file or directory); name a sensor description "
      "(.toml) or a recording (.csv, .txt, .wav, .mat, .sds)");
  EXPECT_EQ(
      error_of_file("traces/none.csv"),
      "traces/none.csv: cannot be read (No such file or directory); name a sensor description "
      "(.toml) or a recording (.csv, .txt, .wav, .mat, .sds)");
}

TEST(Load, SaysWhichKindsOfFileItKnows) {
  EXPECT_EQ(
      error_of_file("traces/README.md"),
      "traces/README.md: the kind of file is not known; name a sensor description (.toml) or a "
      "recording (.csv, .txt, .wav, .mat, .sds)");
  EXPECT_NE(error_of_file(""), "no error");
}

TEST(Load, DoesNotTakeADirectoryForAFile) {
  const std::string directory = ::testing::TempDir() + "folder.csv";
  std::filesystem::create_directories(directory);
  EXPECT_EQ(error_of_file(directory),
            directory +
                ": is a directory; name a sensor description (.toml) or a recording (.csv, .txt, "
                ".wav, .mat, .sds)");
}

}  // namespace
}  // namespace capsoc::sensor
