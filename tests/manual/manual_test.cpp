// What declarations say about values, and texts that shells and roff would take for their own.
#include <gtest/gtest.h>

#include "manual/pages.h"

namespace capsoc::manual {
namespace {

using Words = std::vector<std::string>;

TEST(Value, WordsBetweenBarsAreChoices) {
  EXPECT_EQ(read_value("paper|precise", "").choices, (Words{"paper", "precise"}));
  EXPECT_EQ(read_value("null|file:PATH|pty[:LINK]", "").choices,
            (Words{"null", "file:", "pty", "pty:"}));
}

TEST(Value, ASetIsItsChoicesAndNamesThem) {
  const Value value = read_value("TEXT", "{precise,paper,both}");
  EXPECT_EQ(value.choices, (Words{"precise", "paper", "both"}));
  EXPECT_EQ(value.name, "precise|paper|both");
}

TEST(Value, FilesAreKnownByTheirTypeOrTheirCheck) {
  for (const char* name : {"FILE", "FILE.csv", "FILE[@ADDR]", "ELF", "TRACE", "DIR", "PATH"})
    EXPECT_TRUE(read_value(name, "").file) << name;
  EXPECT_TRUE(read_value("TEXT", "FILE").file);
  EXPECT_TRUE(read_value("FILE|-", "").file);
  for (const char* name : {"FILES_TO_COME", "TEXT", "NS", "PATH=VALUE", ""})
    EXPECT_FALSE(read_value(name, "").file) << name;
  EXPECT_EQ(read_value("FILE.csv", "").suffix, ".csv");
  EXPECT_EQ(read_value("FILE[@ADDR]", "").suffix, "");
}

TEST(Value, OnlyASettingIsASetting) {
  EXPECT_TRUE(read_value("PATH=VALUE", "").setting);
  EXPECT_FALSE(read_value("NAME=VALUE", "").setting);
}

TEST(Value, ARangeIsReadable) {
  EXPECT_EQ(read_value("N", "INT in [1 - 100]").range, "1 to 100");
  EXPECT_EQ(read_value("N", "POSITIVE").range, "");
}

TEST(Value, SettingsOfferWhatTheyTake) {
  Setting setting{"a.b", SettingKind::flag, "true", "", {}};
  EXPECT_EQ(value_of(setting).choices, (Words{"true", "false"}));
  setting.kind = SettingKind::input;
  EXPECT_TRUE(value_of(setting).file);
  setting.kind = SettingKind::integer;
  setting.maximum = 31;
  EXPECT_EQ(value_of(setting).range, "0 to 31");
}

/// A program with one option whose help means something everywhere.
CommandLine hostile() {
  Option option;
  option.names = {"--odd"};
  option.group = "Options";
  option.help = ".it's \\[a:b]\\ `x` ^~";
  option.takes_value = true;
  option.value = read_value("FILE", "");
  return {"1.0", {{"tool"}, "tool: a tool", {option}, {}}, {}, {{"0", "pass"}}};
}

TEST(Pages, ManualEscapesRequestsAndAccents) {
  const std::string page = manual_pages(hostile()).front().text;
  EXPECT_NE(page.find("\n\\&.it\\(aqs \\e[a:b]\\e \\(gax\\(ga \\(ha\\(ti\n"), std::string::npos)
      << page;
  EXPECT_NE(page.find("\ntool \\- a tool\n"), std::string::npos) << page;
}

TEST(Pages, ZshEscapesWhatDividesASpecification) {
  const std::string text = zsh_completion(hostile()).text;
  EXPECT_NE(text.find("'(--odd)--odd=[.it'\\''s \\\\\\[a\\:b\\]\\\\ `x` ^~]:FILE:_files'"),
            std::string::npos)
      << text;
}

TEST(Pages, FishQuotes) {
  const std::string text = fish_completion(hostile()).text;
  EXPECT_NE(text.find("-l odd -r -F -d '.it\\'s \\\\[a:b]\\\\ `x` ^~'"), std::string::npos) << text;
}

TEST(Pages, BashKnowsTheOptionAndItsFiles) {
  const std::string text = bash_completion(hostile()).text;
  EXPECT_NE(text.find("'tool') echo '--odd' ;;"), std::string::npos) << text;
  EXPECT_NE(text.find("'tool --odd') echo 'files' ;;"), std::string::npos) << text;
  EXPECT_EQ(text.find("PROGRAM"), std::string::npos);
}

}  // namespace
}  // namespace capsoc::manual
