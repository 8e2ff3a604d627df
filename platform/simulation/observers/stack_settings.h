// The settings of the stacks.
#pragma once

#include "base/setting_fields.h"

namespace capsoc::run {

struct StackSettings {
  Settings& all;
  FlagField marks{
      all,
      setting("cpu.stack_marks", SettingKind::flag, "false",
              "how deep each stack has been, in reports and results; each instruction is looked "
              "at, which takes several times as long")
          .is_host_side()};
  TextField limit{
      all,
      setting("cpu.stack_limit", SettingKind::text, "",
              "a stack that goes below this address (0x...) or symbol from above it ends the run "
              "with 5; several, separated by commas; with cpu.stack_marks' cost")};
};

}  // namespace capsoc::run
