// The settings of a run.
#pragma once

#include <spdlog/common.h>

#include <string>

#include "armv7m/core.h"
#include "backend/coprocessor_settings.h"
#include "base/setting_fields.h"
#include "inject/inject_settings.h"
#include "inputs/input_settings.h"
#include "observers/schedule_settings.h"
#include "observers/stack_settings.h"
#include "observers/trace_settings.h"
#include "ports/board_pins.h"
#include "ports/port_settings.h"
#include "ports/semihosting_port.h"
#include "ports/uart_lines.h"
#include "results/result_settings.h"
#include "session/checkpoint_settings.h"
#include "soc/board_map.h"

namespace capsoc::run {

struct CpuSettings {
  Settings& all;
  ChoiceField<const armv7m::Profile*> profile{
      all,
      {{"m3", &armv7m::cortex_m3},
       {"m0plus", &armv7m::cortex_m0plus},
       {"m4", &armv7m::cortex_m4},
       {"m4f", &armv7m::cortex_m4f}},
      setting("cpu.profile", SettingKind::choice, "m3",
              "which processor: m3, the Cortex-M3, m0plus, the Cortex-M0+, m4, the Cortex-M4 "
              "without FPU, or m4f, the Cortex-M4 with it")};
  NumberField quantum_ns{
      all, setting("cpu.quantum_ns", SettingKind::number, "1000000",
                   "how far the processor may run ahead, ns")
               .in(1, 1e9)
               .is_host_side()
               .by({"--quantum", "NS", "How far the processor may run ahead; changes speed only"})};
  ChoiceField<armv7m::Executor> executor{
      all,
      {{"translator", armv7m::Executor::translator},
       {"blocks", armv7m::Executor::blocks},
       {"stepping", armv7m::Executor::stepping}},
      setting("cpu.executor", SettingKind::choice, "translator",
              "translator (to x86-64; elsewhere blocks), blocks or stepping; same results")
          .is_host_side()};
  FlagField fast_forward{
      all, setting("cpu.fast_forward", SettingKind::flag, "true",
                   "skip the turns of a loop that only waits for a device; same results")
               .is_host_side()};
  IntegerField translate_after{
      all, setting("cpu.translate_after", SettingKind::integer, "200",
                   "how often the translator executes a block before it translates it")
               .in(1, 254)
               .is_host_side()};
  IntegerField code_buffer_kib{
      all, setting("cpu.code_buffer_kib", SettingKind::integer, "32768",
                   "memory for the translator's code; all of it is dropped when that is full, KiB")
               .in(72, 65536)
               .is_host_side()};
  IntegerField priority_bits{
      all, setting("cpu.priority_bits", SettingKind::integer, "3",
                   "implemented bits of each priority: 3 as the AN385, 8 as QEMU's board")
               .in(3, 8)};
};

/// How slow the memories are.
struct MemorySettings {
  Settings& all;
  IntegerField code_sram{all, wait_states("code_sram", "0")};
  IntegerField block_ram{all, wait_states("block_ram", "0")};
  IntegerField data_sram{all, wait_states("data_sram", "0")};
  IntegerField psram{all, wait_states("psram", "3")};

  soc::MemoryWaits waits() const {
    const auto of = [](const IntegerField& field) { return static_cast<unsigned>(field()); };
    return {of(code_sram), of(block_ram), of(data_sram), of(psram)};
  }
  static Setting wait_states(const std::string& memory, const char* cycles) {
    return setting("memory." + memory + ".wait_states", SettingKind::integer, cycles,
                   "cycles that each word of the " + memory + " waits for beyond its own")
        .in(0, armv7m::timing::most_wait_states);
  }
};

/// When a run ends by itself.
struct LimitSettings {
  Settings& all;
  NumberField simulated_s{
      all,
      setting("run.simlimit_s", SettingKind::number, "0", "limit of simulated time, s; 0: none")
          .in(0, 1e6)
          .is_host_side()
          .by({"--simlimit", "S", "End after S simulated seconds with exit 124"})};
  NumberField host_s{
      all,
      setting("run.timelimit_s", SettingKind::number, "0", "limit of the host's time, s; 0: none")
          .in(0, 1e6)
          .is_host_side()
          .by({"--timelimit", "S", "End after S seconds of the host with exit 124"})};
  NumberField realtime{
      all, setting("run.realtime", SettingKind::number, "0",
                   "simulated seconds a second of the host, which waits where it is faster; 0: as "
                   "fast as it can")
               .in(0, 1e6)
               .is_host_side()
               .by({"--realtime", "[FACTOR]",
                    "Pace simulated time to the host's (1; 0.1: ten times slower)",
                    SettingOption::Form::optional_value, "1"})};
  NumberField end_on_idle{all, setting("run.end_on_idle", SettingKind::number, "0",
                                       "end with 0 when only timers woke the program, and only to "
                                       "sleep again, for N simulated s; 0: never")
                                   .in(0, 1e6)};
};

/// Every setting of a run with its built-in value, in the order in which they are listed.
class RunSettings : public Settings {
 public:
  FirmwareSettings firmware{*this};
  SensorSettings sensor{*this};
  CoprocessorSettings coprocessor{*this};
  TraceSettings trace{*this};
  CpuSettings cpu{*this};
  MemorySettings memory{*this};
  StackSettings stacks{*this};
  ScheduleSettings schedule{*this};
  LimitSettings limits{*this};
  UartSettings uarts{*this};
  PinSettings pins{*this};
  SemihostingSettings semihosting{*this};
  FlagField stop_in_fault{
      *this,
      setting("run.stop_in_fault", SettingKind::flag, "true",
              "a fault handler that branches to itself is a crash, if nothing can interrupt it")
          .is_host_side()};
  ItmSettings itm{*this};
  FlagField golden{
      *this, setting("run.golden", SettingKind::flag, "false",
                     "fit the coprocessor's samples by the CSFN, too")
                 .is_host_side()
                 .by({"--golden", "",
                      "Fit the samples that the coprocessor saw by the CSFN, too, and print both "
                      "answers",
                      SettingOption::Form::flag, "true"})};
  GdbSettings gdb{*this};
  ViewSettings view{*this};
  InjectSettings inject{*this};
  CheckpointSettings checkpoint{*this};
  ResultSettings results{*this};
  FlagField monitor{
      *this, setting("soc.monitor", SettingKind::flag, "false",
                     "check the TLM-2.0 base protocol between all parts of the SoC; slower, same "
                     "results")
                 .is_host_side()};
  ChoiceField<spdlog::level::level_enum> log_level{
      *this,
      {{"trace", spdlog::level::trace},
       {"debug", spdlog::level::debug},
       {"info", spdlog::level::info},
       {"warn", spdlog::level::warn},
       {"error", spdlog::level::err},
       {"off", spdlog::level::off}},
      setting("log.level", SettingKind::choice, "warn", "trace, debug, info, warn, error, off")
          .is_host_side()
          .by({"--log-level", "trace|debug|info|warn|error|off",
               "What the simulator says on stderr"})};
};

/// A command line that gives the same run.
std::string reproducing_command(const Settings& settings);

}  // namespace capsoc::run
