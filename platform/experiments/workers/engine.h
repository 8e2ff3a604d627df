// Worker processes: each run has a separate one, which may crash, hang and use memory without harm
// to the others. A process is a fork of this one, made before there is a simulation, since
// SystemC's kernel starts once in a process; it costs a millisecond where a new program would cost
// ten.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"

namespace capsoc::workers {

/// What one run may take. A run that is beyond is ended, and that is its result.
struct Limits {
  double seconds = 600;
  uint64_t memory_mib = 4096;  ///< of address space
};

/// How a worker ended.
struct Ended {
  std::size_t task = 0;
  std::string ending;  ///< "finished", else what went wrong: see engine.cpp
  std::string result;  ///< only of a finished one
  std::string log;     ///< the end of what it said on stderr; "" for a finished one without failure
  double wall_s = 0;
};

/// The word for a worker that delivered a result.
extern const char* const finished;

class Engine {
 public:
  /// What a worker does: the text of its result, or why there is none.
  using Perform = std::function<Result<std::string>(std::size_t task)>;
  /// Takes the result of one; an Error ends the engine.
  using Take = std::function<std::optional<Error>(Ended ended)>;
  /// Called a few times a second.
  using Tick = std::function<void(std::size_t running)>;

  Engine(unsigned jobs, const Limits& limits, Perform perform);
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  /// Does all tasks, in order as far as there are workers. Ends early with an Error of `take` or
  /// of the system, and when a signal was noted (host::noted_signal()): then workers are ended, and
  /// what they did is nothing.
  std::optional<Error> perform(const std::vector<std::size_t>& tasks, const Take& take,
                               const Tick& tick);

 private:
  struct Worker;

  std::optional<Error> start(std::size_t task);
  std::optional<Error> refill(const std::vector<std::size_t>& tasks, std::size_t& next);
  void wait();
  /// Takes out the workers that are done.
  std::vector<Ended> reap();
  void end_all();

  unsigned jobs_;
  Limits limits_;
  Perform perform_;
  std::vector<Worker> workers_;
};

}  // namespace capsoc::workers
