// What became of damaged files.
#pragma once

#include <gtest/gtest.h>
#include <iconv.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

namespace capsoc::test {

inline std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// One line that a terminal shows as it is: UTF-8 without control characters.
inline bool is_plain(std::string text) {
  std::u32string characters(text.size(), U'\0');
  const iconv_t converter = iconv_open("UTF-32LE", "UTF-8");
  char *from = text.data(), *to = reinterpret_cast<char*>(characters.data());
  std::size_t left = text.size(), room = 4 * characters.size();
  const bool is_utf8 = iconv(converter, &from, &left, &to, &room) != static_cast<std::size_t>(-1);
  iconv_close(converter);
  characters.resize(characters.size() - room / 4);
  for (const char32_t c : characters)
    if (c < 0x20 || (c > 0x7E && c < 0xA0) || (c >= 0x202A && c <= 0x202E)) return false;
  return is_utf8;
}

/// Counts outcomes, and prints them at the end.
class Tally {
 public:
  Tally(const char* kind, uint64_t count) : kind_(kind), count_(count) {}
  ~Tally() {
    std::printf("fuzz: %s: %llu files, %llu accepted, %llu refused\n", kind_,
                static_cast<unsigned long long>(count_), static_cast<unsigned long long>(accepted_),
                static_cast<unsigned long long>(refused_));
    // Both outcomes must occur, or the damage is not worth its name.
    EXPECT_GT(accepted_, count_ / 500);
    EXPECT_GT(refused_, count_ / 100);
  }
  void accept() { ++accepted_; }
  void refuse(const std::string& error, const std::string& file, uint64_t number) {
    ++refused_;
    EXPECT_EQ(error.rfind(file + ":", 0), 0U) << number << ": " << error;
    EXPECT_TRUE(is_plain(error)) << number << ": " << error;
  }

 private:
  const char* kind_;
  uint64_t count_, accepted_ = 0, refused_ = 0;
};

/// A file that is gone with the test.
class TemporaryFile {
 public:
  explicit TemporaryFile(const char* suffix)
      : path_(testing::TempDir() + "fuzz" + std::to_string(getpid()) + suffix) {}
  ~TemporaryFile() { std::remove(path_.c_str()); }
  const std::string& write(const std::string& bytes) const {
    std::ofstream(path_, std::ios::binary) << bytes;
    return path_;
  }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace capsoc::test
