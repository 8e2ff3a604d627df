// The settings of the traces.
#pragma once

#include "base/setting_fields.h"

namespace capsoc::run {

struct TraceSettings {
  Settings& all;
  TextField instructions{
      all, setting("trace.instructions", SettingKind::output, "",
                   "where the instruction trace goes; empty: nowhere")
               .is_place()
               .by({"--trace-instructions", "FILE",
                    "A line for each instruction: time, place, disassembly, changed registers"})};
  TextField bus{
      all,
      setting("trace.bus", SettingKind::output, "", "where the bus trace goes; empty: nowhere")
          .is_place()
          .by({"--trace-bus", "FILE", "A line for each access of the processor and the debugger"})};
  TextField profile{
      all, setting("trace.profile", SettingKind::output, "",
                   "where the function profile goes (callgrind, or .folded); empty: nowhere")
               .is_place()
               .by({"--profile", "FILE",
                    "Cycles of functions and calls, for kcachegrind or, as FILE.folded, for a "
                    "flame graph"})};
  TextField coverage{
      all, setting("trace.coverage", SettingKind::output, "",
                   "where the coverage of the source goes (lcov), added to what it has; empty: "
                   "nowhere")
               .is_place()
               .by({"--coverage", "FILE.info",
                    "Executions of lines, functions and branches, for genhtml; added to a FILE of "
                    "the same program"})};
  TextField waves{
      all, setting("trace.waves", SettingKind::output, "",
                   "where the waves of the SoC go (FST); empty: nowhere")
               .is_place()
               .by({"--trace-waves", "FILE.fst",
                    "Waves of the SoC, whatever the coprocessor is: interrupts, bus, nodes; and "
                    "FILE.gtkw"})};
  TextField timeline{
      all, setting("trace.timeline", SettingKind::output, "",
                   "where the timeline goes (Chrome's trace events); empty: nowhere")
               .is_place()
               .by({"--timeline", "FILE.json",
                    "What happened when, for Perfetto: threads, handlers with their latency, "
                    "samples in the pipeline, UART lines, bus"})};
  TextField translation{
      all, setting("trace.translation", SettingKind::output, "",
                   "where the translator's code goes, with the program's; empty: nowhere")
               .is_place()
               .by({"--trace-translation", "FILE",
                    "Each block that the translator makes code of: instructions and host code"})};
  FlagField perf_map{all, setting("trace.perf_map", SettingKind::flag, "false",
                                  "/tmp/perf-PID.map: what perf calls translated code")
                              .is_place()};
  TextField start{all, setting("trace.start", SettingKind::text, "",
                               "traces begin at a function, an address (0x...) or a time in s")
                           .is_place()};
  TextField stop{all, setting("trace.stop", SettingKind::text, "",
                              "traces end at a function, an address (0x...) or a time in s")
                          .is_place()};
  IntegerField depth{
      all, setting("trace.depth", SettingKind::integer, "0",
                   "lines of instruction and bus trace that are kept, the last ones; 0: all")
               .in(0, 1e7)
               .is_place()};
  FlagField fetches{
      all, setting("trace.fetches", SettingKind::flag, "false", "fetches in the bus trace, too")
               .is_place()};
};

}  // namespace capsoc::run
