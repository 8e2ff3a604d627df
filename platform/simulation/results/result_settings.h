// The settings of what a run leaves.
#pragma once

#include "base/setting_fields.h"

namespace capsoc::run {

struct ResultSettings {
  Settings& all;
  TextField json{
      all, setting("results.json", SettingKind::output, "", "where the results go; empty: nowhere")
               .is_place()
               .by({"--json", "FILE", "Write the results as JSON"})};
  TextField html{
      all, setting("results.html", SettingKind::output, "",
                   "where the report goes, with curves (HTML); empty: nowhere")
               .is_place()
               .by({"--html", "FILE", "Write a report with curves that a browser shows offline"})};
  FlagField curves{
      all,
      setting("results.curves", SettingKind::flag, "false",
              "curves and UART 0's text in the results, for capsoc report; --html implies it")
          .is_place()
          .by({"--curves", "", "Curves and UART 0's text in the results too, for capsoc report",
               SettingOption::Form::flag, "true"})};
  TextField session{
      all, setting("results.session", SettingKind::output, "",
                   "where the session goes, to be simulated again by capsoc replay; empty: nowhere")
               .is_place()
               .by({"--record-session", "FILE",
                    "Write what came from outside, when, and hashes of the state, for capsoc "
                    "replay"})};
  NumberField keep_last_s{
      all,
      setting("results.keep_last_s", SettingKind::number, "0",
              "the last simulated seconds that the session has at least, s; 0: it begins at the "
              "start of the run")
          .in(0, 1e6)
          .is_place()
          .by({"--keep-last", "S",
               "Of --record-session only the last S simulated seconds, from a kept state "
               "on"})};
  /// The run gathers what a report draws.
  bool wants_curves() const { return curves() || !html.empty(); }
  TextField record{all,
                   setting("results.record", SettingKind::output, "",
                           "where the coprocessor's samples go (.csv, .wav, .mat, .sds); empty: "
                           "nowhere")
                       .is_place()
                       .by({"--record", "FILE.csv",
                            "Write the samples that the coprocessor saw as a recording (or "
                            ".wav, .mat, .sds)"})};
  TextField record_columns{
      all, setting("results.record_columns", SettingKind::text, "",
                   "columns of that file, separated by commas; empty: t,u,v,angle_deg")
               .is_place()
               .by({"--record-columns", "NAME,...",
                    "What that recording has of each sample (a wrong name lists all)"})};
};

}  // namespace capsoc::run
