#include "session/run_settings.h"

#include <gtest/gtest.h>

#include <set>

namespace capsoc::run {
namespace {

TEST(RunSettings, EachTakesItsOwnBuiltInValue) {
  RunSettings settings;
  std::vector<std::pair<std::string, std::string>> built_in;
  for (const Setting& setting : settings.all()) built_in.emplace_back(setting.path, setting.value);
  ASSERT_GT(built_in.size(), 60U);
  for (const auto& [path, value] : built_in) {
    const auto error = settings.set(path, value, SettingSource::command_line, path);
    EXPECT_FALSE(error) << error->text;
  }
}

TEST(RunSettings, NoPathAndNoOptionIsThereTwice) {
  const RunSettings settings;
  std::set<std::string> paths, options;
  for (const Setting& setting : settings.all()) {
    EXPECT_TRUE(paths.insert(setting.path).second) << setting.path;
    EXPECT_FALSE(setting.help.empty()) << setting.path;
    const SettingOption& option = setting.command;
    if (option.name.empty()) continue;
    EXPECT_TRUE(options.insert(option.name).second) << option.name;
    EXPECT_FALSE(option.help.empty()) << option.name;
    const bool needs_none = option.form == SettingOption::Form::flag;
    EXPECT_EQ(option.argument.empty(), needs_none) << option.name;
    EXPECT_EQ(needs_none || option.form == SettingOption::Form::optional_value,
              !option.implied.empty())
        << option.name;
  }
}

TEST(RunSettings, ForgottenTheyAreAsDeclared) {
  RunSettings settings;
  const RunSettings fresh;
  for (const char* assignment :
       {"cpu.quantum_ns=7", "coprocessor.arithmetic=paper", "coprocessor.paper_operand_bits=16",
        "sensor.a1=0.25", "program.samples=3", "run.until_uart=done", "gdb.halt=true"})
    ASSERT_FALSE(settings.set_assignment(assignment)) << assignment;
  ASSERT_NE(settings.all().size(), fresh.all().size()) << "program.samples is of a group";
  for (int time = 0; time < 2; ++time) {
    settings.forget_values();
    ASSERT_EQ(settings.all().size(), fresh.all().size());
    for (std::size_t i = 0; i < fresh.all().size(); ++i) {
      const Setting &ours = settings.all()[i], &theirs = fresh.all()[i];
      EXPECT_EQ(ours.value, theirs.value) << ours.path;
      EXPECT_EQ(ours.source, theirs.source) << ours.path;
      EXPECT_EQ(ours.name(), theirs.name());
      EXPECT_EQ(ours.origin, theirs.origin) << ours.path;
    }
    EXPECT_EQ(settings.coprocessor.options().arithmetic, fresh.coprocessor.options().arithmetic);
    EXPECT_EQ(settings.coprocessor.options().paper_operand_bits, 32);
    EXPECT_FALSE(settings.gdb.halt());
    ASSERT_FALSE(settings.set_assignment("program.rate=5"));
    ASSERT_EQ(settings.of_group("program.").size(), 1U);
  }
}

TEST(RunSettings, WhatIsImpliedIsTaken) {
  RunSettings settings;
  std::vector<std::pair<std::string, std::string>> implied;
  for (const Setting& setting : settings.all())
    if (!setting.command.implied.empty())
      implied.emplace_back(setting.path, setting.command.implied);
  for (const auto& [path, value] : implied)
    EXPECT_FALSE(settings.set(path, value, SettingSource::command_line, path)) << path;
  EXPECT_EQ(settings.gdb.port(), 3333);
  EXPECT_TRUE(settings.golden() && settings.gdb.halt() && settings.uarts.wait());
}

TEST(RunSettings, ACommandThatReproducesARunLeavesPlacesOut) {
  RunSettings settings;
  for (const char* assignment : {"cpu.quantum_ns=1000", "results.json=r.json", "gdb.port=0",
                                 "run.until_uart=a b", "trace.depth=5"})
    ASSERT_FALSE(settings.set_assignment(assignment));
  EXPECT_EQ(reproducing_command(settings),
            "capsoc run -C cpu.quantum_ns=1000 -C 'run.until_uart=a b'");
}

}  // namespace
}  // namespace capsoc::run
