// The settings of the ITM, the debugger and the live page.
#pragma once

#include "base/setting_fields.h"

namespace capsoc::run {

/// Where the text of the processor's ITM goes.
struct ItmSettings {
  Settings& all;
  TextField backend{
      all, setting("itm.backend", SettingKind::backend, "null",
                   "where the processor's ITM text goes: stdout, null, log (level info) or "
                   "file:PATH")
               .is_place()
               .by({"--itm", "stdout|null|log|file:PATH",
                    "Where the text on the ITM's stimulus port goes"})};
  IntegerField port{all,
                    setting("itm.port", SettingKind::integer, "0", "stimulus port of that text")
                        .in(0, 31)
                        .is_place()};
};

struct GdbSettings {
  Settings& all;
  IntegerField port{
      all, setting("gdb.port", SettingKind::integer, "-1",
                   "port of the GDB server; 0: a free one, -1: none")
               .in(-1, 65535)
               .is_place()
               .by({"--gdb", "[PORT]",
                    "GDB server on the loopback interface (default port 3333; 0: a free one)",
                    SettingOption::Form::optional_value, "3333"})};
  FlagField halt{all, setting("gdb.halt", SettingKind::flag, "false",
                              "wait for a debugger before the first instruction")
                          .is_place()
                          .by({"--halt", "", "Wait for a debugger before the first instruction",
                               SettingOption::Form::flag, "true"})};
  IntegerField history_mb{
      all, setting("gdb.history_mb", SettingKind::integer, "0",
                   "memory for the past that the debugger can go back to, MB; 0: none")
               .in(0, 65536)
               .is_place()
               .by({"--gdb-history", "[MB]",
                    "Let the debugger go back, with so much memory for the past (64 MB)",
                    SettingOption::Form::optional_value, "64"})};
  IntegerField on_failure{
      all, setting("gdb.on_failure", SettingKind::integer, "-1",
                   "port of a GDB server that opens where a run fails; 0: a free one, -1: none")
               .in(-1, 65535)
               .is_place()
               .by({"--gdb-on-failure", "[PORT]",
                    "Where the run fails, wait for a debugger that can go back (default port 3333)",
                    SettingOption::Form::optional_value, "3333"})};

  /// What the past may take, MB; 0: it is not kept.
  long long memory_mb() const {
    constexpr long long of_a_failure = 64;
    return on_failure() >= 0 && history_mb() == 0 ? of_a_failure : history_mb();
  }
};

struct ViewSettings {
  Settings& all;
  IntegerField port{
      all, setting("view.port", SettingKind::integer, "-1",
                   "port of the live page, on the loopback interface; 0: a free one, -1: none")
               .in(-1, 65535)
               .is_place()
               .by({"--view", "[PORT]",
                    "Show the run live on a page for a browser (default: a free port); it begins "
                    "when the page opens, at the speed of --realtime",
                    SettingOption::Form::optional_value, "0"})};
};

}  // namespace capsoc::run
