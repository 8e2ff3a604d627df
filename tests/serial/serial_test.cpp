// The host's end of a line: names of backends, patterns, files. Clients are in tests/system.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <iterator>

#include "serial/line_watch.h"
#include "serial/open_backend.h"
#include "serial/serial_line.h"

namespace capsoc::serial {
namespace {

bool never() {
  return false;
}

LineWatch watch(const std::string& until, const std::string& fail) {
  auto patterns = Patterns::make(until, fail);
  EXPECT_TRUE(patterns) << patterns.error();
  return LineWatch(patterns.value());
}

/// The first match while the text passes without a pause.
std::optional<LineWatch::Match> feed(LineWatch& lines, const std::string& text) {
  for (const char c : text)
    if (auto match = lines.feed(static_cast<uint8_t>(c), false)) return match;
  return std::nullopt;
}

TEST(OpenBackend, KnowsItsNames) {
  for (const char* spec : {"null", "stdout", "stderr", "tcp", "tcp:0", "pty"})
    EXPECT_TRUE(open_backend(spec, "--uart0", never)) << spec;
  for (const char* spec : {"", "file:", "file", "pty:", "tcp:", "tcp:x", "tcp:70000", "tcp:-1",
                           "null:", "serial", "stdio:1"}) {
    const auto refused = open_backend(spec, "--uart0", never);
    ASSERT_FALSE(refused) << spec;
    EXPECT_EQ(refused.error().rfind("--uart0", 0), 0U) << refused.error();
  }
}

TEST(LineWatch, LooksAtWholeLinesWithoutTheirEnd) {
  LineWatch lines = watch("^pass$", "");
  EXPECT_FALSE(feed(lines, "pass"));
  EXPECT_TRUE(feed(lines, "\r\n"));
  EXPECT_FALSE(feed(lines, "no pass\n"));
  EXPECT_FALSE(feed(lines, "pas\ns\n"));
}

TEST(LineWatch, LooksAtAPromptWhenTheTransmitterRunsDry) {
  LineWatch lines = watch("> $", "");
  EXPECT_FALSE(feed(lines, "login> "));
  LineWatch dry = watch("> $", "");
  feed(dry, "login>");
  EXPECT_TRUE(dry.feed(' ', true));
}

TEST(LineWatch, TheFailureComesFirst) {
  LineWatch lines = watch("test", "FAIL");
  const auto match = feed(lines, "test 1: FAIL\x01\xff\n");
  ASSERT_TRUE(match);
  EXPECT_TRUE(match->failed);
  EXPECT_EQ(match->line, "test 1: FAIL??");
}

TEST(LineWatch, EndlessLinesAreLookedAtInPieces) {
  LineWatch lines = watch("x{100}$", "");
  EXPECT_TRUE(feed(lines, std::string(LineWatch::longest_line, 'x')));
  EXPECT_FALSE(feed(lines, std::string(10, 'x') + "\n"));
}

TEST(LineWatch, BadPatternsAreSentences) {
  for (const char* pattern : {"(", "[", "a**", "\\", "(?P<n", "x{99999}"}) {
    const auto patterns = Patterns::make("", pattern);
    ASSERT_FALSE(patterns) << pattern;
    EXPECT_EQ(patterns.error().rfind("--fail-uart", 0), 0U) << patterns.error();
    EXPECT_EQ(patterns.error().find('\n'), std::string::npos);
  }
}

TEST(SerialLine, CopiesToItsLogAndReadsItsInput) {
  const std::string base = testing::TempDir() + "serial" + std::to_string(getpid());
  const std::string input = base + ".in", log = base + ".log", out = base + ".out";
  std::ofstream(input, std::ios::binary) << std::string("a\0b", 3);
  {
    auto line = SerialLine::open({"uart2", "file:" + out, input, log, false, {}}, never);
    ASSERT_TRUE(line) << line.error();
    EXPECT_EQ(line.value()->next_input(), uint8_t{'a'});
    EXPECT_EQ(line.value()->next_input(), uint8_t{0});
    EXPECT_EQ(line.value()->next_input(), uint8_t{'b'});
    EXPECT_FALSE(line.value()->next_input());
    for (const char c : std::string("text without an end")) line.value()->transmitted(c, false);
    line.value()->finish();
    EXPECT_EQ(line.value()->bytes(), 19U);
    EXPECT_EQ(line.value()->failures().size(), 0u);
  }
  for (const std::string& path : {log, out}) {
    std::ifstream file(path);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "text without an end");
  }
  for (const std::string& path : {input, log, out}) std::remove(path.c_str());
}

TEST(SerialLine, AFullDiskIsSaid) {
  auto line = SerialLine::open({"uart0", "file:/dev/full", "", "/dev/full", false, {}}, never);
  ASSERT_TRUE(line) << line.error();
  line.value()->transmitted('x', true);
  line.value()->finish();
  const auto failures = line.value()->failures();
  ASSERT_EQ(failures.size(), 2u) << "the file and the log";
  for (const std::string& failure : failures)
    EXPECT_NE(failure.find("/dev/full: takes no more bytes"), std::string::npos);
}

}  // namespace
}  // namespace capsoc::serial
