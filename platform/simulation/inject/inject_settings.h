// The settings of fault injection.
#pragma once

#include "base/setting_fields.h"

namespace capsoc::run {

/// Without a value they are no part of results: a run without faults has the same bytes as ever.
struct InjectSettings {
  Settings& all;
  TextField faults{
      all,
      injected(setting("inject.faults", SettingKind::text, "",
                       "faults to inject, WHAT PLACE at WHEN (docs/guide/safety.md), separated by "
                       "commas"))
          .by({"--inject", "FAULT",
               "Inject a fault, for instance 'flip cpu.r3[5] at 0.25s'; may be repeated",
               SettingOption::Form::list})};
  TextField file{all, injected(setting("inject.file", SettingKind::input, "",
                                       "a file with a fault a line; empty: none"))
                          .by({"--inject-file", "FILE",
                               "Inject the faults of a file, one a line; # begins a comment"})};

  static Setting injected(Setting declared) {
    declared.optional = true;
    return declared;
  }
};

}  // namespace capsoc::run
