// Which faults are drawn, and what counts as wrong.
#pragma once

#include "base/setting_fields.h"
#include "inject/fault.h"

namespace capsoc::fault {

/// Settings of a trial in addition to those of its run.
class TrialSettings : public Settings {
 public:
  IntegerField seed{*this,
                    setting("fault.seed", SettingKind::integer, "1", "of the fault").in(0, 0x1p63)};
  TextField units{*this,
                  setting("fault.units", SettingKind::text, "coprocessor",
                          "beginnings of the units to draw from, separated by commas (capsoc run "
                          "--list-fault-places); each bit is as likely as another one")};
  ChoiceField<inject::Fault::Kind> kind{
      *this,
      {{"flip", inject::Fault::Kind::flip},
       {"stuck0", inject::Fault::Kind::stuck0},
       {"stuck1", inject::Fault::Kind::stuck1}},
      setting("fault.kind", SettingKind::choice, "flip", "flip: once; stuck0, stuck1: for ever")};
  FlagField pipeline{*this, setting("fault.pipeline", SettingKind::flag, "false",
                                    "at a sample and one of the cycles that the coprocessor's "
                                    "pipeline takes for it, instead of any time")};
  TextField line{*this, setting("fault.line", SettingKind::text, "",
                                "a fault to try instead of a drawn one (docs/guide/safety.md)")};
  FlagField prune{*this, setting("fault.prune", SettingKind::flag, "true",
                                 "flips of state that nothing reads are latent without a "
                                 "simulation; the row says why")};
  NumberField from_s{*this,
                     seconds("fault.from_s", "402", "the first instant of a drawn fault, s")};
  NumberField to_s{*this, seconds("fault.to_s", "410", "the last one, s")};
  NumberField until_s{
      *this, seconds("fault.until_s", "418", "where states are compared at the latest, s")};
  NumberField wait_s{*this, seconds("fault.wait_s", "12",
                                    "how much longer than without the fault a program may take "
                                    "before it hangs, s: a watchdog may have to end it")};
  NumberField limit_deg{*this, setting("fault.limit_deg", SettingKind::number, "0.1",
                                       "an angle that is further off is wrong, deg")
                                   .in(0, 180)};
  IntegerField silent_samples{*this, setting("fault.silent_samples", SettingKind::integer, "3",
                                             "samples that may be wrong without a word")
                                         .in(0, 1e9)};

 private:
  static Setting seconds(const char* path, const char* value, const char* text) {
    return setting(path, SettingKind::number, value, text).in(0.001, 1e6);
  }
};

}  // namespace capsoc::fault
