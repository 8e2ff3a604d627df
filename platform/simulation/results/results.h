// The result file of a run, and the table for the user. All other reports are made from the result
// file.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "armv7m/executors/translator/translator.h"
#include "base/curve.h"
#include "base/result.h"
#include "base/setting_fields.h"
#include "golden/golden.h"
#include "inputs/input_file.h"
#include "metrics/metrics.h"
#include "metrics/program_verdict.h"
#include "results/exit_codes.h"
#include "trace/profile.h"

namespace capsoc::run {

/// Data for the plots and texts of a report, beyond the figures that every run has.
struct ReportData {
  Curves curves;  ///< of metrics::SampleCurves
  std::string uart0_text;
  uint64_t uart0_left_out = 0;  ///< bytes, in the middle
};

/// A setting of the program in the run.
struct ProgramValue {
  std::string name, value;
};

/// A stack of the program and its deepest use (cpu.stack_marks).
struct StackUse {
  std::string name;
  uint32_t top, lowest;
};

/// Processor time of a task of the program's operating system (tasks.current).
struct TaskTime {
  std::string name;
  uint32_t address;  ///< 0: handlers, and code before the first task
  uint64_t cycles, switches;
};

/// Cycles from pending to the first instruction of the handler (results.latencies).
struct InterruptWait {
  struct Bin {
    uint64_t from, to, count;
  };
  unsigned exception;
  std::string name;
  uint64_t count, least, most, sum;
  std::vector<Bin> histogram;
};

/// A fault of the run and its outcome (inject/injector.h).
struct FaultOutcome {
  std::string fault;  ///< the line that repeats it
  bool applied = false;
  double time_s = 0;                    ///< where it was applied
  uint64_t cycle = 0, instruction = 0;  ///< ditto
  uint64_t before = 0, after = 0;       ///< what the place held before and after
  uint64_t changes = 0;                 ///< how often it changed something
  std::string note;                     ///< why it was not applied, or changed nothing; ""

  template <typename Archive>
  void visit(Archive& archive) {
    archive("fault", fault);
    archive("applied", applied);
    archive("time_s", time_s);
    archive("cycle", cycle);
    archive("instruction", instruction);
    archive("before", before);
    archive("after", after);
    archive("changes", changes);
    archive("note", note);
  }
};
/// As `faults` of a result has it.
nlohmann::ordered_json to_json(const FaultOutcome& fault);
/// As an entry of `profile` of a result.
nlohmann::ordered_json to_json(const trace::FunctionCost& function);

/// What became of one of several sensors.
struct SensorResult {
  std::string file;
  uint64_t samples = 0, valid = 0;  ///< results, and those of them with VALID
  metrics::ParameterWords words;    ///< of the last result
  std::optional<metrics::Parameters> truth;
  metrics::AngleErrors errors;  ///< of all results as if in demodulation
};

/// The complete result of a run.
struct RunResult {
  int code = exit_code::pass;
  std::string reason;
  double simulated_s = 0;
  double wall_s = 0;
  uint64_t instructions = 0;
  uint64_t cycles = 0;
  std::optional<armv7m::TranslationCounts> translation;  ///< of the translator, if it was used
  uint64_t samples = 0;
  metrics::Convergence convergence;
  std::vector<std::string> sensor_warnings;  ///< where the program does not match the sensor
  metrics::ParameterWords words;
  std::optional<metrics::Parameters> truth;
  bool phi_comparable = true;  ///< metrics::Metrics::phi_comparable()
  metrics::AngleErrors errors;
  std::vector<SensorResult> sensors;               ///< empty with one
  std::optional<metrics::ProgramVerdict> verdict;  ///< of a program that states one
  uint64_t uart0_bytes = 0;
  std::string uart0_sha256;
  std::vector<Input> inputs;
  std::vector<ProgramValue> program_settings;
  std::vector<StackUse> stacks;                ///< empty unless they were followed
  std::vector<TaskTime> tasks;                 ///< empty unless they were followed
  std::vector<InterruptWait> interrupt_waits;  ///< ditto
  std::vector<FaultOutcome> faults;            ///< those that were injected
  std::string command;                         ///< a command that reproduces the run
  std::vector<std::string> lost;               ///< a sentence for each output that is not whole
  std::string divergence;                    ///< "" unless model and RTL of the coprocessor differ
  std::string fault_report;                  ///< "" unless the firmware crashed
  std::string place_report;                  ///< "" unless the run ended where it should not
  std::optional<golden::Golden> golden;      ///< only when it was asked for
  std::optional<ReportData> report;          ///< only when it was asked for
  std::vector<trace::FunctionCost> profile;  ///< only with one: the functions that took the most
};

/// The result file's contents; keys are documented in docs/reference/results.md.
nlohmann::ordered_json to_json(const RunResult& result, const Settings& settings);

/// A result file's text. Bytes that are no UTF-8 (of an option, of a UART) are replaced.
std::string to_text(const nlohmann::ordered_json& json);

/// How many times faster than real time, "1234" or "0.021".
std::string speed_of(double simulated_s, double wall_s);

/// Parameters next to the truth and the angle error before and after, as text; only the last lines
/// for a run that took no sample of the sensor.
std::string to_table(const RunResult& result);

/// Versions of the program and of the libraries that it runs on, name by name.
nlohmann::ordered_json versions();

}  // namespace capsoc::run
