#include "host/files.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace capsoc::host {
namespace {

namespace fs = std::filesystem;

class Files : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::TempDir() + std::to_string(getpid()) + "files_test";
    fs::remove_all(folder_);
    fs::create_directory(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  std::string contents(const std::string& name) const {
    std::ifstream file(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  long count() const {
    return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
  }

  std::string folder_;
};

TEST_F(Files, AFileReplacesTheOldOneAndLeavesNothingBeside) {
  ASSERT_FALSE(write_whole(path("a"), "one"));
  ASSERT_FALSE(write_whole(path("a"), "two"));
  EXPECT_EQ(contents("a"), "two");
  EXPECT_EQ(count(), 1);
}

TEST_F(Files, TogetherMeansAllOrNone) {
  ASSERT_FALSE(write_whole(path("a"), "old"));
  fs::create_directory(path("b"));
  for (const std::string& second : {path("b"), path("none/b")}) {
    const auto error = write_together({{path("a"), "new"}, {second, "new"}});
    ASSERT_TRUE(error);
    EXPECT_EQ(error->text.rfind(second, 0), 0u) << error->text;
    EXPECT_EQ(contents("a"), "old");
  }
  EXPECT_EQ(count(), 2);
}

TEST_F(Files, WhetherItIsWritableIsTriedWithoutATrace) {
  EXPECT_FALSE(check_writable(path("a")));
  EXPECT_TRUE(check_writable(path("none/a")));
  EXPECT_TRUE(check_writable(folder_));
  EXPECT_EQ(count(), 0);
}

}  // namespace
}  // namespace capsoc::host
