// What happened when, on tracks for people: Chrome's trace event format.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "armv7m/core.h"
#include "base/result.h"
#include "host/growing_stream.h"
#include "kit/probe.h"
#include "soc/soc.h"
#include "trace/bus_targets.h"
#include "trace/bus_trace.h"
#include "trace/functions.h"

namespace capsoc::trace {

/// A JSON file for Perfetto (ui.perfetto.dev) and chrome://tracing, written while the run lasts, in
/// memory that does not grow with it. Its processes and threads are parts of the chip:
///
/// - processor: the threads of the program, each with a slice while it runs or sleeps;
///   the handlers, nested, with the cycles from the interrupt line's edge to the first instruction;
/// - interrupts: a line each, while it is high;
/// - coprocessor: the stages of the pipeline, a slice for each sample in them, and the results;
/// - UARTs: lines of text, from their first byte to their last;
/// - bus: transfers of each port.
///
/// Threads are told apart by their stacks, as CallTree does, and named by the function in which
/// they are seen first.
class Timeline {
 public:
  /// An Error: nothing can be written there. `soc` and `functions` must outlive it.
  static Result<std::unique_ptr<Timeline>> create(const std::string& path, soc::Soc& soc,
                                                  Functions& functions);

  /// Events go to the file while this is true. What lasts is cut there, and begins there again.
  void open(bool on, uint64_t picoseconds);

  void entered(const armv7m::Core& core, unsigned exception, armv7m::Entry how, uint64_t since);
  void returned(const armv7m::Core& core);
  void started(const armv7m::Core& core);
  /// The trace begins here, in the middle of a program, between two instructions.
  void begin(const armv7m::Core& core);
  void sleeps(bool is_asleep);
  void transfer(uint64_t begin_ps, uint64_t end_ps, const BusAccess& access);

  /// The last call. `end`: how the run ended, as an event.
  std::optional<Error> finish(uint64_t picoseconds, const std::string& end);

 private:
  /// A thread of the trace format: a process and a number in it.
  struct Track {
    unsigned process = 0, thread = 0;
  };
  struct Handler {
    std::string name, arguments;
    uint64_t begin_ps = 0;
  };
  /// A thread of the program.
  struct Thread {
    uint32_t stack = 0;  ///< where it was interrupted
    Track track;
  };
  struct Line {
    Track track;
    std::string name;
    const kit::InterruptLine* source = nullptr;
    bool is_high = false;
    uint64_t since_ps = 0, since_cycle = 0;
    bool is_served = true;  ///< its handler began since it rose
  };
  struct Text {
    std::string line;
    uint64_t begin_ps = 0, end_ps = 0;
  };

  Timeline(host::GrowingStream file, soc::Soc& soc, Functions& functions);
  void name_tracks();
  void connect_interrupts();
  void connect_coprocessor();
  void connect_uarts();
  void name(unsigned process, const std::string& text);
  void name(Track track, const std::string& text);
  void event(const std::string& members);
  void slice(Track track, const std::string& name, uint64_t begin_ps, uint64_t end_ps,
             const std::string& arguments = "");
  void counter(const char* name, uint64_t at_ps, const std::string& value);

  void line(std::size_t index, bool level);
  void result(const coprocessor::Nodes& nodes, uint64_t number);
  void byte(std::size_t uart, uint8_t byte);
  void flush(std::size_t uart);
  void cut(uint64_t picoseconds);
  void rest(uint64_t picoseconds);
  void end_sleep(uint64_t picoseconds);
  void end_handler(uint64_t picoseconds);
  void resume(const armv7m::Core& core);
  void begin_thread(const std::string& function);
  std::string latency(unsigned exception, uint64_t cycle);
  uint64_t ps(uint64_t cycle) const;

  host::GrowingStream file_;
  soc::Soc& soc_;
  Functions& functions_;
  BusTargets targets_;
  bool open_ = true, is_empty_ = true;
  uint64_t opened_ps_ = 0;

  std::vector<Handler> handlers_;
  std::optional<Thread> running_;  ///< none before the first instruction
  uint64_t running_since_ps_ = 0;
  std::optional<uint64_t> asleep_since_ps_;
  std::deque<Thread> suspended_;
  unsigned threads_ = 0;
  std::vector<Line> lines_;
  std::multimap<unsigned, std::size_t> lines_of_;  ///< by the exception's number
  std::array<Text, soc::Soc::uart_count> texts_;
  std::deque<std::pair<uint64_t, uint64_t>> taken_;  ///< samples in the pipeline: number, time
  std::map<std::string, unsigned> ports_;
  std::vector<kit::Listening> listening_;
};

}  // namespace capsoc::trace
