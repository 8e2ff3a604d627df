#include "trace/line_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace capsoc::trace {
namespace {

struct LineFiles : testing::Test {
  std::string path = testing::TempDir() + std::to_string(getpid()) + "lines.txt";
  ~LineFiles() override { std::remove(path.c_str()); }

  std::string contents() const {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

TEST_F(LineFiles, AllLinesOrTheLast) {
  for (const auto& [depth, expected] :
       {std::pair{0U, "head\n1\n2\n3\n"}, {2U, "head\n2\n3\n"}, {9U, "head\n1\n2\n3\n"}}) {
    auto file = LineFile::open(path, depth);
    ASSERT_TRUE(file) << file.error();
    file.value()->heading("head");
    for (const char* line : {"1", "2", "3"}) file.value()->put(line);
    EXPECT_FALSE(file.value()->finish());
    EXPECT_EQ(contents(), expected);
  }
}

TEST_F(LineFiles, NothingIsLeftOfAFileThatIsNotFinished) {
  std::ofstream(path) << "before";
  {
    auto file = LineFile::open(path, 0);
    file.value()->put("half");
  }
  EXPECT_EQ(contents(), "before");
  EXPECT_FALSE(std::filesystem::exists(path + "." + std::to_string(getpid()) + ".tmp"));
}

TEST_F(LineFiles, WhatCannotBeWrittenIsSaid) {
  EXPECT_NE(LineFile::open("/nonexistent/x", 0).error().find("/nonexistent/x: cannot be written"),
            std::string::npos);
  auto full = LineFile::open("/dev/full", 0);
  ASSERT_TRUE(full) << full.error();
  full.value()->put(std::string(100'000, 'x'));
  const auto error = full.value()->finish();
  ASSERT_TRUE(error);
  EXPECT_NE(error->text.find("/dev/full: cannot be written"), std::string::npos) << error->text;
}

}  // namespace
}  // namespace capsoc::trace
