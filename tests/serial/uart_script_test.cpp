// Scripts of a UART: what is a step, and when each is done.
#include "serial/uart_script.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "base/archive.h"

namespace capsoc::serial {
namespace {

constexpr uint64_t ms = 1'000'000'000;

UartScript script(const std::string& text) {
  auto steps = parse_uart_script("s", text);
  EXPECT_TRUE(steps) << steps.error();
  return {"s", std::move(steps.value())};
}

std::string taken(UartScript& played) {
  std::string bytes;
  while (const auto byte = played.next_input()) bytes += static_cast<char>(*byte);
  return bytes;
}

/// The chip says a text without a pause.
void say(UartScript& played, const std::string& text, uint64_t now) {
  for (std::size_t i = 0; i < text.size(); ++i)
    if (played.sent(static_cast<uint8_t>(text[i]), i + 1 == text.size())) played.play(now);
}

TEST(UartScript, StepsAreDoneInOrder) {
  UartScript played = script(
      "# a dialogue\n\nat 0.002\nsend \"a\\x42\\r\\\"\\\\\"\nexpect /^login: / within 0.5\n"
      "send \"me\\n\"\nwait 0.001\nsend \"!\"\n");
  played.play(0);
  EXPECT_EQ(played.next_time(), 2 * ms);
  played.play(1 * ms);
  EXPECT_FALSE(played.has_input());
  played.play(2 * ms);
  EXPECT_EQ(taken(played), "aB\r\"\\");
  EXPECT_EQ(played.next_time(), 502 * ms);
  say(played, "welcome\nno login: here\n", 3 * ms);
  EXPECT_FALSE(played.has_input());
  EXPECT_EQ(played.unfinished(), "s:5: the run ended before a line matched /^login: /");
  say(played, "login: ", 4 * ms);
  EXPECT_EQ(taken(played), "me\n");
  EXPECT_EQ(played.next_time(), 5 * ms);
  played.play(5 * ms);
  EXPECT_EQ(played.unfinished(), "s: the program did not take the last 1 bytes");
  EXPECT_EQ(taken(played), "!");
  EXPECT_EQ(played.unfinished(), "");
  EXPECT_EQ(played.next_time(), std::nullopt);
}

TEST(UartScript, WhatWasSaidBeforeIsHeard) {
  UartScript played = script("wait 0.001\nexpect /one/\nexpect /two/\nexpect /three/\nsend \"x\"");
  played.play(0);
  say(played, "one\ntwo\nand three", 0);
  EXPECT_FALSE(played.has_input());
  played.play(1 * ms);
  EXPECT_EQ(taken(played), "x");
}

TEST(UartScript, AnExpectationTakesTheLinesUpToItsOwn) {
  UartScript played = script("expect /b/\nexpect /a/\nsend \"x\"");
  played.play(0);
  say(played, "a\nb\n", 0);
  EXPECT_FALSE(played.has_input()) << "a came before b";
  say(played, "a\n", 0);
  EXPECT_EQ(taken(played), "x");
}

TEST(UartScript, AnExpectationMayBeMissed) {
  UartScript played = script("expect /ready/ within 0.01\nsend \"x\"");
  played.play(0);
  say(played, "not yet\n", 9 * ms);
  played.play(10 * ms);
  EXPECT_EQ(played.failure(), "s:1: no line matched /ready/ within 0.01 s");
  say(played, "ready\n", 11 * ms);
  played.play(11 * ms);
  EXPECT_FALSE(played.has_input());
  EXPECT_EQ(played.next_time(), std::nullopt);
}

TEST(UartScript, AFloodIsBounded) {
  UartScript played = script("wait 1\nexpect /end/\nsend \"x\"");
  played.play(0);
  say(played, "end\n" + std::string(10 * UartScript::most_unheard, '.') + "\n", 0);
  played.play(1000 * ms);
  EXPECT_FALSE(played.has_input()) << "forgotten";
  say(played, "end\n", 1000 * ms);
  EXPECT_TRUE(played.has_input());
}

TEST(UartScript, GoesOnFromSavedState) {
  const std::string text =
      "expect /go/\nwait 0.002\nsend \"abc\"\nexpect /yes/ within 1\nsend \"d\"";
  UartScript saved = script(text);
  saved.play(0);
  say(saved, "go\nye", 1 * ms);
  StateWriter writer;
  saved.visit(writer);
  const std::string bytes = writer.take();
  UartScript loaded = script(text);
  StateReader reader(bytes);
  loaded.visit(reader);
  ASSERT_TRUE(reader.ok()) << reader.problem();
  for (UartScript* each : {&saved, &loaded}) {
    each->play(2 * ms);
    EXPECT_FALSE(each->has_input());
    each->play(3 * ms);
    EXPECT_EQ(taken(*each), "abc");
    say(*each, "s\n", 4 * ms);
    EXPECT_EQ(taken(*each), "d");
  }
  UartScript shorter = script("");
  StateReader again(bytes);
  shorter.visit(again);
  EXPECT_TRUE(again.ok()) << "a run without a script goes on without";
  EXPECT_EQ(shorter.unfinished(), "");
}

TEST(UartScript, AWrongLineIsNamed) {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"send\n", "s:1: write send \"TEXT\""},
      {"\n# x\nsend hello\n", "s:3: write send \"TEXT\""},
      {"send \"a\" b", "s:1: write send \"TEXT\""},
      {"send \"\\q\"", "s:1: knows \\n \\r"},
      {"send \"\\x4\"", "s:1: knows \\n \\r"},
      {"expect login", "s:1: write expect /REGEX/"},
      {"expect //", "s:1: write expect /REGEX/"},
      {"expect /a/ within", "s:1: write expect /REGEX/"},
      {"expect /a/ within 0", "s:1: write expect /REGEX/"},
      {"expect /a/ within -1", "s:1: write expect /REGEX/"},
      {"expect /(/", "s:1: /(/ is no regular expression"},
      {"at noon", "s:1: needs a time"},
      {"wait -1", "s:1: needs a time"},
      {"wait 1e7", "s:1: needs a time"},
      {"wait nan", "s:1: needs a time"},
      {"hello", "s:1: is no step; write at SECONDS"},
  };
  for (const auto& [text, sentence] : wrong) {
    const auto steps = parse_uart_script("s", text);
    ASSERT_FALSE(steps) << text;
    EXPECT_EQ(steps.error().rfind(sentence, 0), 0U) << steps.error();
    EXPECT_EQ(steps.error().find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace capsoc::serial
