// The settings of the schedule.
#pragma once

#include "base/setting_fields.h"

namespace capsoc::run {

/// How to find the tasks of an operating system, and whether interrupts are timed.
struct ScheduleSettings {
  Settings& all;
  TextField current{all, setting("tasks.current", SettingKind::text, "",
                                 "where the pointer to the present task is, a symbol or an address "
                                 "(0x...): times of the tasks in the results; empty: none")
                             .is_place()};
  IntegerField name_offset{all, setting("tasks.name_offset", SettingKind::integer, "-1",
                                        "where in a task its name is, bytes; -1: nowhere")
                                    .in(-1, 65535)
                                    .is_place()};
  FlagField name_is_pointer{all, setting("tasks.name_is_pointer", SettingKind::flag, "false",
                                         "a pointer to the name is there, not the name itself")
                                     .is_place()};
  FlagField latencies{
      all, setting("results.latencies", SettingKind::flag, "false",
                   "how long each interrupt waited for its handler, in the results")
               .is_place()
               .by({"--latencies", "",
                    "How long each interrupt waited for its handler, in the results (--json)",
                    SettingOption::Form::flag, "true"})};
};

}  // namespace capsoc::run
