#include "host/temporary_folder.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>

namespace capsoc::host {
namespace {

namespace fs = std::filesystem;

class Folders : public testing::Test {
 protected:
  void SetUp() override {
    place_ = testing::TempDir() + std::to_string(getpid()) + "temporary_folder_test";
    fs::remove_all(place_);
    fs::create_directory(place_);
    setenv("TMPDIR", place_.c_str(), 1);
  }
  void TearDown() override {
    unsetenv("TMPDIR");
    fs::remove_all(place_);
  }

  static TemporaryFolder make() {
    auto made = TemporaryFolder::make("test");
    EXPECT_TRUE(made) << made.error();
    return std::move(made.value());
  }
  /// One that a process left which was killed, and that is some seconds old.
  std::string left_over(int seconds) const {
    int ends[2];
    EXPECT_EQ(pipe(ends), 0);
    const pid_t child = fork();
    if (child == 0) {
      const TemporaryFolder folder = make();
      std::ofstream(folder.path() + "/file") << "text";
      const std::string path = folder.path() + "\n";
      if (write(ends[1], path.data(), path.size()) < 0) _exit(1);
      pause();
    }
    close(ends[1]);
    std::string path;
    for (char c = 0; read(ends[0], &c, 1) == 1 && c != '\n';) path += c;
    close(ends[0]);
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::seconds(seconds));
    return path;
  }

  std::string place_;
};

TEST_F(Folders, ItIsGoneWithItsOwner) {
  std::optional<TemporaryFolder> folder(make());
  const std::string path = folder->path();
  EXPECT_EQ(path.rfind(place_ + "/capsoc-test-", 0), 0U);
  std::ofstream(path + "/file") << "text";
  std::optional<TemporaryFolder> other(std::move(*folder));
  folder.reset();
  EXPECT_TRUE(fs::exists(path + "/file"));
  other.reset();
  EXPECT_FALSE(fs::exists(path));
}

TEST_F(Folders, AForkedCopyLeavesIt) {
  auto folder = std::make_optional(make());
  const std::string path = folder->path();
  const pid_t child = fork();
  if (child == 0) {
    folder.reset();
    _exit(0);
  }
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(fs::exists(path));
}

TEST_F(Folders, WhatAKilledProcessLeftIsRemovedByTheNext) {
  const std::string young = left_over(1);
  const std::string old = left_over(100);
  ASSERT_TRUE(fs::exists(old + "/file"));
  const TemporaryFolder living = make();
  fs::last_write_time(living.path(), fs::file_time_type::clock::now() - std::chrono::hours(1));
  const TemporaryFolder next = make();
  EXPECT_FALSE(fs::exists(old));
  EXPECT_TRUE(fs::exists(young));
  EXPECT_TRUE(fs::exists(living.path()));
}

TEST_F(Folders, OthersAreNotTouched) {
  const std::string other = left_over(100);
  ASSERT_TRUE(TemporaryFolder::make("tes"));
  ASSERT_TRUE(TemporaryFolder::make("test-more"));
  EXPECT_TRUE(fs::exists(other));
}

TEST_F(Folders, WithoutAPlaceItSaysWhatToDo) {
  setenv("TMPDIR", (place_ + "/none").c_str(), 1);
  const auto folder = TemporaryFolder::make("test");
  ASSERT_FALSE(folder);
  EXPECT_NE(folder.error().find("set TMPDIR"), std::string::npos) << folder.error();
}

}  // namespace
}  // namespace capsoc::host
