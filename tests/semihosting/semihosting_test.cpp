// Semihosting calls against a memory of 64 KiB and a directory, well-formed and random ones.
#include "semihosting/semihosting.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

namespace capsoc::semihosting {
namespace {

namespace fs = std::filesystem;

using Outcome = Semihosting::Outcome;

class FakeMemory : public GuestMemory {
 public:
  static constexpr uint32_t base = 0x20000000, size = 0x10000;
  bool read(uint32_t address, void* data, uint32_t count) override {
    if (!inside(address, count)) return false;
    if (count != 0) std::memcpy(data, &bytes[address - base], count);
    return true;
  }
  bool write(uint32_t address, const void* data, uint32_t count) override {
    if (!inside(address, count)) return false;
    if (count != 0) std::memcpy(&bytes[address - base], data, count);
    return true;
  }
  std::vector<uint8_t> bytes = std::vector<uint8_t>(size + 1);

 private:
  static bool inside(uint32_t address, uint32_t count) {
    return address >= base && address - base <= size && count <= size - (address - base);
  }
};

/// Keeps what is written, and has something to read.
class FakeBackend : public serial::CharacterBackend {
 public:
  explicit FakeBackend(std::string& written) : written_(written) {}
  void write(std::string_view bytes) override { written_ += bytes; }
  std::string read() override { return std::exchange(input, {}); }
  bool asks() override { return waits; }

  std::string input = "typed\n";
  bool waits = false;

 private:
  std::string& written_;
};

class SemihostingTest : public testing::Test {
 protected:
  static constexpr uint32_t block = FakeMemory::base, name = block + 0x100, other = block + 0x200,
                            buffer = block + 0x1000;
  static constexpr uint32_t bad = 0x40004000;

  SemihostingTest() {
    fs::create_directories(inside / "folder");
    std::ofstream(outside) << "secret";
    fs::create_symlink(outside, inside / "link");
    fs::create_symlink(folder, inside / "way_out");
  }
  ~SemihostingTest() override { fs::remove_all(folder); }

  static GuestFiles files(const fs::path& directory) {
    auto opened = GuestFiles::in(directory.string());
    EXPECT_TRUE(opened);
    return std::move(opened.value());
  }
  uint32_t call(uint32_t operation, const std::vector<uint32_t>& words) {
    memory.write(block, words.data(), static_cast<uint32_t>(4 * words.size()));
    uint32_t result = operation;
    EXPECT_EQ(guest.call(operation, block, result), Outcome::answered);
    return result;
  }
  uint32_t put(uint32_t address, const std::string& text) {
    memory.write(address, text.c_str(), static_cast<uint32_t>(text.size() + 1));
    return static_cast<uint32_t>(text.size());
  }
  uint32_t open(const std::string& path, uint32_t mode) {
    return call(0x01, {name, mode, put(name, path)});
  }
  int error() { return static_cast<int>(call(0x13, {})); }
  std::string text_at(uint32_t address) {
    return reinterpret_cast<const char*>(&memory.bytes[address - FakeMemory::base]);
  }

  fs::path folder = fs::temp_directory_path() / ("capsoc_semihosting" + std::to_string(getpid()));
  fs::path inside = folder / "guest", outside = folder / "secret";
  FakeMemory memory;
  std::string console_text;
  FakeBackend* const host = new FakeBackend(console_text);
  Console console{std::unique_ptr<FakeBackend>(host), [] { return false; }};
  uint64_t now_ns = 0;
  Environment environment{
      "program.elf one two", 1767225600, {1, 2, 3, 4}, [this] { return now_ns; }};
  // Made on first use: the directory is there by then.
  struct Late {
    SemihostingTest& test;
    std::optional<Semihosting> made;
    Outcome call(uint32_t operation, uint32_t argument, uint32_t& result) {
      if (!made) made.emplace(test.memory, test.files(test.inside), test.console, test.environment);
      return made->call(operation, argument, result);
    }
  } guest{*this, std::nullopt};
};

constexpr uint32_t failure = 0xFFFFFFFF;

TEST_F(SemihostingTest, AFileIsWrittenReadSoughtAndMeasured) {
  const uint32_t file = open("folder/notes", 6);  // w+
  ASSERT_NE(file, failure);
  EXPECT_EQ(call(0x05, {file, buffer, put(buffer, "hello world")}), 0U);
  EXPECT_EQ(call(0x0C, {file}), 11U);
  EXPECT_EQ(call(0x0A, {file, 6}), 0U);
  EXPECT_EQ(call(0x06, {file, buffer, 100}), 95U) << "what the buffer lacks";
  EXPECT_EQ(text_at(buffer).substr(0, 5), "world");
  EXPECT_EQ(call(0x06, {file, buffer, 100}), 100U) << "the end of the file";
  EXPECT_EQ(call(0x09, {file}), 0U);
  EXPECT_EQ(call(0x02, {file}), 0U);
  EXPECT_EQ(call(0x02, {file}), failure);
  EXPECT_EQ(error(), EBADF);
  EXPECT_EQ(call(0x0F, {name, put(name, "folder/notes"), other, put(other, "kept")}), 0U);
  EXPECT_TRUE(fs::exists(inside / "kept"));
  EXPECT_EQ(call(0x0E, {name, put(name, "kept")}), 0U);
  EXPECT_FALSE(fs::exists(inside / "kept"));
}

TEST_F(SemihostingTest, NothingOutsideTheDirectoryIsReached) {
  for (const std::string& path :
       {std::string("../secret"), outside.string(), std::string("folder/../../secret"),
        std::string("link"), std::string("way_out/secret"), std::string(".."), std::string("."),
        std::string("/etc/passwd"), std::string("folder"), std::string("")})
    for (uint32_t mode = 0; mode < 13; ++mode) {
      EXPECT_EQ(open(path, mode), failure) << path;
      EXPECT_NE(error(), 0);
    }
  call(0x0E, {name, put(name, "way_out/secret")});
  call(0x0E, {name, put(name, "../secret")});
  call(0x0F, {name, put(name, "../secret"), other, put(other, "mine")});
  open("mine2", 4);
  call(0x0F, {name, put(name, "mine2"), other, put(other, "way_out/secret")});
  std::ifstream file(outside);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "secret");
}

TEST_F(SemihostingTest, WithoutADirectoryThereAreNoFiles) {
  Semihosting bare(memory, GuestFiles(), console, environment);
  const uint32_t words[] = {name, 0, put(name, "notes")};
  memory.write(block, words, sizeof words);
  uint32_t result = 1;
  EXPECT_EQ(bare.call(0x01, block, result), Outcome::answered);
  EXPECT_EQ(result, failure);
  EXPECT_EQ(bare.call(0x13, 0, result), Outcome::answered);
  EXPECT_EQ(result, static_cast<uint32_t>(EACCES));
}

TEST_F(SemihostingTest, TheConsole) {
  const uint32_t out = open(":tt", 4), in = open(":tt", 0);
  EXPECT_EQ(call(0x05, {out, buffer, put(buffer, "one\n")}), 0U);
  EXPECT_EQ(console_text, "one\n");
  EXPECT_EQ(call(0x05, {in, buffer, 1}), 1U) << "stdin is not written";
  EXPECT_EQ(call(0x09, {out}), 1U);
  EXPECT_EQ(call(0x07, {}), uint32_t{'t'});
  EXPECT_EQ(call(0x06, {in, buffer, 100}), 95U);
  EXPECT_EQ(call(0x06, {in, buffer, 100}), 100U) << "the end";
  EXPECT_EQ(call(0x07, {}), failure);
  put(block, "text\n");
  uint32_t result = 0;
  guest.call(0x04, block, result);
  guest.call(0x03, block, result);
  console.flush();
  EXPECT_EQ(console_text, "one\ntext\nt");
}

TEST_F(SemihostingTest, AReadOfTheConsoleCanBeRepeated) {
  const uint32_t in = open(":tt", 0);
  EXPECT_EQ(call(0x06, {in, buffer, 100}), 94U);
  EXPECT_EQ(call(0x06, {99, buffer, 100}), 100U);
  EXPECT_EQ(error(), EBADF);
  host->waits = true;
  for (const uint32_t operation : {0x06U, 0x07U}) {
    const std::vector<uint32_t> words = {in, buffer, 100};
    memory.write(block, words.data(), 12);
    const std::vector<uint8_t> before = memory.bytes;
    uint32_t result = operation;
    EXPECT_EQ(guest.call(operation, block, result), Outcome::asks_again);
    EXPECT_EQ(result, operation);
    EXPECT_EQ(memory.bytes, before);
    EXPECT_EQ(error(), EBADF) << "of the call before";
  }
  host->input = "two\nlines";
  EXPECT_EQ(call(0x06, {in, buffer, 100}), 96U) << "one at a time";
  EXPECT_EQ(text_at(buffer).substr(0, 4), "two\n");
  EXPECT_EQ(call(0x07, {}), uint32_t{'l'});
  EXPECT_EQ(call(0x06, {in, buffer, 100}), 96U);
  host->waits = false;
  EXPECT_EQ(call(0x06, {in, buffer, 100}), 100U) << "the end of the input";
}

/// The specification: R0 has "the same value as field 3" if the call has failed.
TEST_F(SemihostingTest, AReadThatFailsHasReadNothing) {
  put(buffer, "x");
  const uint32_t written = open("f", 4), screen = open(":tt", 4);
  for (const uint32_t handle : {written, screen, 77U}) {
    EXPECT_EQ(call(0x06, {handle, buffer, 5}), 5U);
    EXPECT_EQ(error(), EBADF);
  }
  EXPECT_EQ(text_at(buffer), "x");
}

TEST_F(SemihostingTest, AWrittenTextHasAnyLengthAndEndsWithMemoryAtTheLatest) {
  std::string text;
  for (unsigned i = 0; i < 30000; ++i) text += static_cast<char>('a' + i % 26);
  uint32_t result = 0;
  for (const uint32_t begin : {buffer, buffer + 1, buffer + 63}) {
    console_text.clear();
    put(begin, text);
    EXPECT_EQ(guest.call(0x04, begin, result), Outcome::answered);
    console.flush();
    EXPECT_EQ(console_text, text);
  }
  console_text.clear();
  const uint32_t last = FakeMemory::base + FakeMemory::size - 3;
  memory.write(last, "end", 3);
  EXPECT_EQ(guest.call(0x04, last, result), Outcome::answered);
  EXPECT_EQ(guest.call(0x04, bad, result), Outcome::answered);
  console.flush();
  EXPECT_EQ(console_text, "end");
}

TEST_F(SemihostingTest, TimeIsSimulatedTime) {
  now_ns = 3'250'000'007;
  EXPECT_EQ(call(0x10, {}), 325U);
  EXPECT_EQ(call(0x11, {}), 1767225603U);
  EXPECT_EQ(call(0x31, {}), 1'000'000'000U);
  EXPECT_EQ(call(0x30, {}), 0U);
  uint64_t ticks = 0;
  memory.read(block, &ticks, sizeof ticks);
  EXPECT_EQ(ticks, now_ns);
}

TEST_F(SemihostingTest, CommandLineHeapFeaturesAndTemporaryNames) {
  EXPECT_EQ(call(0x15, {buffer, 100}), 0U);
  EXPECT_EQ(text_at(buffer), "program.elf one two");
  uint32_t length = 0;
  memory.read(block + 4, &length, 4);
  EXPECT_EQ(length, 19U);
  EXPECT_EQ(call(0x15, {buffer, 19}), failure) << "no room for the zero";
  EXPECT_EQ(call(0x16, {buffer}), 0U);
  EXPECT_EQ(memory.bytes[buffer - FakeMemory::base + 12], 4);
  const uint32_t features = open(":semihosting-features", 0);
  EXPECT_EQ(call(0x06, {features, buffer, 5}), 0U);
  EXPECT_EQ(text_at(buffer).substr(0, 5), "SHFB\x03");
  EXPECT_EQ(call(0x0D, {buffer, 7, 100}), 0U);
  EXPECT_EQ(text_at(buffer), "capsoc-007.tmp");
  EXPECT_EQ(call(0x0D, {buffer, 256, 100}), failure);
  EXPECT_EQ(call(0x0D, {buffer, 7, 14}), failure);
}

TEST_F(SemihostingTest, TheEnd) {
  uint32_t result = 0;
  EXPECT_EQ(guest.call(0x18, 0x20026, result), Outcome::ended);
  EXPECT_EQ(guest.made->exit_status(), 0);
  EXPECT_EQ(guest.call(0x18, 0x20023, result), Outcome::ended);
  EXPECT_EQ(guest.made->exit_status(), 1);
  const uint32_t words[] = {0x20026, 42};
  memory.write(block, words, sizeof words);
  EXPECT_EQ(guest.call(0x20, block, result), Outcome::ended);
  EXPECT_EQ(guest.made->exit_status(), 42);
  EXPECT_EQ(guest.call(0x20, bad, result), Outcome::ended);
  EXPECT_EQ(guest.made->exit_status(), 1);
}

TEST_F(SemihostingTest, PointersOutsideMemoryAreErrors) {
  const uint32_t file = open("f", 6);
  for (uint32_t operation = 0; operation < 0x40; ++operation) {
    if (operation == 0x18 || operation == 0x20) continue;
    uint32_t result = operation;
    EXPECT_EQ(guest.call(operation, bad, result), Outcome::answered);
    EXPECT_EQ(guest.call(operation, 0xFFFFFFFE, result), Outcome::answered);
  }
  EXPECT_EQ(call(0x05, {file, bad, 8}), 8U);
  EXPECT_EQ(error(), EFAULT);
  EXPECT_EQ(call(0x05, {file, buffer, 16}), 0U);
  EXPECT_EQ(call(0x0A, {file, 0}), 0U);
  EXPECT_EQ(call(0x06, {file, bad, 8}), 8U);
  EXPECT_EQ(error(), EFAULT);
  EXPECT_EQ(call(0x01, {bad, 0, 4}), failure);
  EXPECT_EQ(call(0x01, {name, 0, 0xFFFFFFFF}), failure);
  EXPECT_EQ(error(), ENAMETOOLONG);
  EXPECT_EQ(call(0x15, {bad, 100}), failure);
  EXPECT_EQ(call(0x16, {bad}), failure);
}

TEST_F(SemihostingTest, HandlesAndSizesHaveBounds) {
  unsigned opened = 0;
  while (open("f", 6) != failure && opened < 1000) ++opened;
  EXPECT_EQ(opened, 64U);
  EXPECT_EQ(error(), EMFILE);
  EXPECT_EQ(call(0x0A, {1, 0x0FFFFFFF}), 0U);
  EXPECT_EQ(call(0x05, {1, buffer, 16}), 16U);
  EXPECT_EQ(error(), EFBIG);
}

TEST_F(SemihostingTest, RandomCallsDoNothingWorse) {
  std::mt19937 random(20260801);
  const auto odd = [&]() -> uint32_t {
    switch (random() % 6) {
      case 0:
        return static_cast<uint32_t>(random());
      case 1:
        return FakeMemory::base + FakeMemory::size - random() % 40;
      case 2:
        return random() % 12;
      case 3:
        return bad;
      default:
        return FakeMemory::base + random() % FakeMemory::size;
    }
  };
  const std::vector<std::string> names = {"a",   "../b",     "link", "way_out/x",
                                          ":tt", "folder/c", "/d"};
  for (unsigned i = 0; i < 20000; ++i) {
    put(name, names[random() % names.size()]);
    std::vector<uint32_t> words = {odd(), odd(), odd() % 5000, odd()};
    if (random() % 2 == 0)
      words = {name, static_cast<uint32_t>(random() % 13),
               static_cast<uint32_t>(text_at(name).size())};
    memory.write(block, words.data(), static_cast<uint32_t>(4 * words.size()));
    uint32_t operation = random() % 0x34, result = 0;
    if (operation == 0x18 || operation == 0x20) continue;
    EXPECT_EQ(guest.call(operation, random() % 8 == 0 ? odd() : block, result), Outcome::answered);
  }
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator(folder)) found.push_back(entry.path().filename());
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, (std::vector<std::string>{"guest", "secret"}));
  EXPECT_EQ(fs::file_size(outside), 6U);
}

}  // namespace
}  // namespace capsoc::semihosting
