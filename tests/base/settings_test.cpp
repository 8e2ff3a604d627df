#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>

#include "base/setting_fields.h"

namespace capsoc {
namespace {

enum class Speed { fast, slow };

struct Example : Settings {
  NumberField quantum_ns{
      *this, setting("cpu.quantum_ns", SettingKind::number, "10", "how far").in(1, 100)};
  ChoiceField<Speed> executor{*this,
                              {{"blocks", Speed::fast}, {"stepping", Speed::slow}},
                              setting("cpu.executor", SettingKind::choice, "blocks", "which")};
  IntegerField lines{*this, setting("cpu.lines", SettingKind::integer, "3", "how many").in(0, 32)};
  FlagField stops{*this, setting("run.stops", SettingKind::flag, "false", "whether")};
  TextField log{*this, setting("run.log", SettingKind::output, "", "where")};
};

TEST(Settings, AFieldIsItsValueAsSomethingOfItsType) {
  Example s;
  EXPECT_DOUBLE_EQ(s.quantum_ns(), 10);
  EXPECT_EQ(s.executor(), Speed::fast);
  EXPECT_EQ(s.lines(), 3);
  EXPECT_FALSE(s.stops());
  EXPECT_TRUE(s.log.empty());
  for (const char* assignment : {"cpu.quantum_ns=2.5", "cpu.executor=stepping", "cpu.lines=32",
                                 "run.stops=true", "run.log=a b"})
    EXPECT_FALSE(s.set_assignment(assignment)) << assignment;
  EXPECT_DOUBLE_EQ(s.quantum_ns(), 2.5);
  EXPECT_EQ(s.executor(), Speed::slow);
  EXPECT_EQ(s.lines(), 32);
  EXPECT_TRUE(s.stops());
  EXPECT_EQ(s.log(), "a b");
  EXPECT_FALSE(s.log.is_built_in());
  EXPECT_EQ(s.log.name(), "run.log");
  EXPECT_FALSE(s.set("run.log", "c", SettingSource::command_line, "--log"));
  EXPECT_EQ(s.log.name(), "--log") << "as sentences name it";
}

TEST(Settings, FieldsAreListedInTheOrderOfTheirDeclarations) {
  const Example s;
  std::string paths;
  for (const Setting& setting : s.all()) paths += setting.path + " ";
  EXPECT_EQ(paths, "cpu.quantum_ns cpu.executor cpu.lines run.stops run.log ");
}

TEST(Settings, TheHigherPrecedenceWinsWhateverTheOrder) {
  Example s;
  EXPECT_FALSE(s.set("cpu.quantum_ns", "20", SettingSource::command_line, "x"));
  EXPECT_FALSE(s.set("cpu.quantum_ns", "30", SettingSource::file, "x"));
  EXPECT_DOUBLE_EQ(s.quantum_ns(), 20);
}

TEST(Settings, ARefusedValueChangesNothing) {
  Example s;
  for (const char* value : {"0", "101", "ten", "", "nan", "1e999", "5 "})
    EXPECT_TRUE(s.set("cpu.quantum_ns", value, SettingSource::command_line, "x")) << value;
  EXPECT_TRUE(s.set("cpu.lines", "2.5", SettingSource::command_line, "x"));
  EXPECT_TRUE(s.set("cpu.executor", "fast", SettingSource::command_line, "x"));
  EXPECT_DOUBLE_EQ(s.quantum_ns(), 10);
  EXPECT_EQ(s.lines(), 3);
}

TEST(Settings, ATextThatDoesNotWinIsParsedAndNotTaken) {
  Example s;
  EXPECT_FALSE(s.set("cpu.lines", "7", SettingSource::command_line, "x"));
  EXPECT_FALSE(s.set("cpu.lines", "9", SettingSource::environment, "x"));
  EXPECT_EQ(s.lines(), 7);
  EXPECT_EQ(s.lines.text(), "7");
  const auto error = s.set("cpu.lines", "99", SettingSource::environment, "here");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->text, "here: cpu.lines = 99 is out of range; give 0 to 32");
  EXPECT_FALSE(s.set("cpu.executor", "stepping", SettingSource::command_line, "x"));
  EXPECT_FALSE(s.set("cpu.executor", "blocks", SettingSource::file, "x"));
  EXPECT_EQ(s.executor(), Speed::slow);
}

TEST(Settings, AnUnknownNameIsAnsweredWithTheNearest) {
  Example s;
  const auto error = s.set_assignment("cpu.quantum=5");
  ASSERT_TRUE(error);
  EXPECT_NE(error->text.find("did you mean cpu.quantum_ns"), std::string::npos) << error->text;
  EXPECT_TRUE(s.set_assignment("nothing"));
  EXPECT_TRUE(s.set_assignment("=1"));
}

TEST(Settings, AFileNamesItsLine) {
  const std::string path = testing::TempDir() + std::to_string(getpid()) + "settings.toml";
  std::ofstream(path) << "[cpu]\nquantum_ns = 40\nlines = 99\n";
  Example s;
  const auto error = s.read_file(path);
  std::remove(path.c_str());
  ASSERT_TRUE(error);
  EXPECT_NE(error->text.find(path + ":3"), std::string::npos) << error->text;
}

TEST(Settings, TablesInTablesArePathsToo) {
  const std::string path = testing::TempDir() + std::to_string(getpid()) + "nested.toml";
  std::ofstream(path) << "[cpu]\nlines = 4\n[cpu.cache]\nways = 2\n";
  Example s;
  const IntegerField ways(s, setting("cpu.cache.ways", SettingKind::integer, "1", "").in(1, 8));
  EXPECT_FALSE(s.read_file(path));
  EXPECT_EQ(ways(), 2);
  std::ofstream(path) << "[cpu]\nlines = 4\n[cpu.lines]\nways = 2\n";
  EXPECT_TRUE(s.read_file(path));
  std::ofstream(path) << "[cpu.cache]\nways = [2]\n";
  const auto error = s.read_file(path);
  std::remove(path.c_str());
  ASSERT_TRUE(error);
  EXPECT_EQ(error->text, path + ":2: cpu.cache.ways must be a text, a number or true/false");
}

TEST(Settings, ALetterBeyondAsciiOutsideATextIsRefusedWithItsLine) {
  const std::string path = testing::TempDir() + std::to_string(getpid()) + "letters.toml";
  for (const char* letter : {"\u00e9", "\u0416", "\u00a0", "\u2003", "\u0301", "\U0001f600"}) {
    std::ofstream(path) << "[cpu]\nlines " << letter << "= 4\n";
    Example s;
    const auto error = s.read_file(path);
    if (!error) continue;  // some are spaces to the reader
    EXPECT_EQ(error->text.rfind(path + ":2: ", 0), 0U) << error->text;
  }
  std::remove(path.c_str());
}

TEST(Settings, AGroupTakesNamesThatNobodyKnewBefore) {
  Example s;
  s.add(SettingGroup{"program.", "of the program"});
  EXPECT_FALSE(s.set("program.rate_hz", "500", SettingSource::command_line, "-P rate_hz=500"));
  char name[] = "CAPSOC_PROGRAM_RATE_HZ=250", other[] = "CAPSOC_PROGRAM_STEP=0.5";
  char* environment[] = {name, other, nullptr};
  EXPECT_FALSE(s.read_environment(environment));
  const std::vector<Setting> members = s.of_group("program.");
  ASSERT_EQ(members.size(), 2U);
  EXPECT_EQ(members[0].value, "500") << "the command line wins";
  EXPECT_EQ(members[0].origin, "-P rate_hz=500");
  EXPECT_EQ(members[1].path, "program.step");
  EXPECT_EQ(members[1].origin, "environment CAPSOC_PROGRAM_STEP");
  for (const char* path : {"program.", "program.A", "program.a b", "program.a.b", "programs.a"})
    EXPECT_TRUE(s.set(path, "1", SettingSource::command_line, "x")) << path;
  EXPECT_EQ(s.of_group("program.").size(), 2U);
}

TEST(Settings, TheEnvironmentIsRead) {
  Example s;
  char name[] = "CAPSOC_CPU_EXECUTOR=stepping";
  char* environment[] = {name, nullptr};
  EXPECT_FALSE(s.read_environment(environment));
  EXPECT_EQ(s.executor(), Speed::slow);
}

}  // namespace
}  // namespace capsoc
