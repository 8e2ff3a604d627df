// One object for all observers of a run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "loader/elf_image.h"
#include "soc/soc.h"
#include "trace/bus_trace.h"
#include "trace/call_tree.h"
#include "trace/functions.h"
#include "trace/instruction_trace.h"
#include "trace/profile.h"
#include "trace/timeline.h"
#include "trace/translation_trace.h"
#include "trace/waves.h"
#include "trace/window.h"

namespace capsoc::trace {

/// The traces and their files; an empty file name: no such trace.
struct TraceOptions {
  std::string instructions, bus, profile, waves, translation, timeline;
  std::string start, stop;  ///< see Bound::parse()
  std::size_t depth = 0;    ///< instruction and bus trace: the last lines only; 0: all
  bool fetches = false;     ///< instruction fetches in the bus trace
  bool perf_map = false;    ///< names of translated code for perf, see TranslationTrace

  bool any() const {
    return !instructions.empty() || !bus.empty() || !profile.empty() || !waves.empty() ||
           !translation.empty() || !timeline.empty() || perf_map;
  }
};

/// Attached before the simulation starts or between two instructions, detached by its destruction,
/// after which nothing is simulated. Changes only the simulation's speed.
class Tracer : private armv7m::Observer {
 public:
  /// `images`: where the symbols are; `line_of` is asked at the end, for the profile. An Error: a
  /// file that cannot be written or a wrong bound; nothing is left behind. `soc` must outlive it.
  static Result<std::unique_ptr<Tracer>> attach(soc::Soc& soc, const TraceOptions& options,
                                                const std::vector<const loader::ElfImage*>& images,
                                                LineOf line_of);
  ~Tracer() override;
  /// The simulation stands in the middle of a program, between two instructions: the traces begin
  /// with what is under way there. Not needed before a reset.
  void begin();
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  /// Writes what is left. After the simulation.
  std::vector<Error> finish();
  /// Writes the rest of the timeline, with how the run ended.
  std::optional<Error> finish_timeline(const std::string& end);

  /// After finish(): what a profile says of the functions that took the most; none without one.
  std::vector<FunctionCost> top_functions();

 private:
  explicit Tracer(soc::Soc& soc, const TraceOptions& options) : soc_(soc), options_(options) {}
  std::optional<Error> open();
  void connect();

  void issued(const armv7m::Core& core, const armv7m::DecodedOp& op) override;
  void retired(const armv7m::Core& core, const armv7m::DecodedOp& op) override;
  void entered(const armv7m::Core& core, unsigned exception, armv7m::Entry how,
               uint64_t since) override;
  void returned(const armv7m::Core& core, unsigned exception) override;
  void accessed(const armv7m::Core& core, const armv7m::DirectAccess& access) override;
  void started(const armv7m::Core& core) override;
  void transfer(const tlm::tlm_generic_payload& payload, const sc_core::sc_time& begin,
                const sc_core::sc_time& end);
  void result(const coprocessor::Nodes& nodes);

  uint64_t picoseconds_of(uint64_t cycle) const;
  double seconds_of(uint64_t cycle) const;
  bool open_at(uint64_t picoseconds);
  void follow_window(uint64_t picoseconds);

  soc::Soc& soc_;
  TraceOptions options_;
  Functions functions_;
  std::optional<Window> window_;
  std::unique_ptr<InstructionTrace> instructions_;
  std::unique_ptr<BusTrace> bus_;
  std::unique_ptr<CallTree> calls_;
  std::unique_ptr<Waves> waves_;
  std::unique_ptr<TranslationTrace> translation_;
  std::unique_ptr<Timeline> timeline_;
  kit::Listening transfers_, results_;
  std::string program_;
  LineOf line_of_;
};

}  // namespace capsoc::trace
