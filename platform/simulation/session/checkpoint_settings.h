// The settings of checkpoints.
#pragma once

#include "base/setting_fields.h"

namespace capsoc::run {

struct CheckpointSettings {
  Settings& all;
  TextField save{
      all,
      setting("checkpoint.save", SettingKind::text, "",
              "checkpoints on the way, FILE@SECONDS of simulated time, separated by commas")
          .is_place()
          .by({"--save", "FILE@S", "Save the whole state at a simulated time in s; may be repeated",
               SettingOption::Form::list})};
  NumberField every_s{
      all, setting("checkpoint.every_s", SettingKind::number, "0",
                   "a checkpoint every N simulated s; 0: none")
               .in(0, 1e6)
               .is_place()
               .by({"--save-every", "S",
                    "Save it every N simulated seconds, in checkpoint-<seconds>.capsoc"})};
  TextField prefix{
      all, setting("checkpoint.prefix", SettingKind::text, "checkpoint-",
                   "begins the names of these and of those on SIGUSR1: PREFIX<seconds>.capsoc")
               .is_place()};
  TextField restore{all, setting("checkpoint.restore", SettingKind::input, "",
                                 "the run resumes from this checkpoint; empty: from reset")
                             .is_host_side()
                             .by({"--restore", "FILE", "Resume from a state that --save wrote"})};
};

}  // namespace capsoc::run
