// A simulation in its own process, under the session that forked it.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "host/descriptor.h"
#include "service/message.h"

namespace capsoc::service {

/// What a worker and its session write in one place, since a message would come too late: which
/// call is to stop.
struct Shared {
  std::atomic<uint64_t> interrupted_call{0};
};

/// Such a place for each worker of a session. All of its processes map them at one address.
class SharedPlaces {
 public:
  SharedPlaces();
  /// Null: none is left. It is free again when the last copy of the pointer has gone.
  std::shared_ptr<Shared> take();

 private:
  static constexpr std::size_t count = 4096;
  struct Places {
    ~Places();
    Shared* mapped = nullptr;
    std::vector<std::size_t> free;
  };
  std::shared_ptr<Places> places_;
};

/// The exit code of a worker that got no more memory.
inline constexpr int out_of_memory = 77;

/// The methods that a session has for itself; others are those of board_verbs(). A request is
/// {"call", "method", "params"}, its answer {"call"} with "result" or "error". To a request with
/// the "id" of a client the answer is {"call"} and a frame, the client's answer. Construction takes
/// settings and, to continue from a snapshot, what snapshot_method answered: held, and frames; or,
/// to repeat a recorded session, `expected`, with its `end`, and frames with its inputs and its
/// state.
inline constexpr const char* construct_method = "worker.construct";
inline constexpr const char* snapshot_method = "worker.snapshot";

/// For going back (session_history.cpp). leave_method takes a goal, {"unit", "value"}, and answers
/// with `history`, `told` and frames, or, when the goal is ahead, goes there and answers with
/// `state`. Instead of a goal it may take `select`, the number of a history. It answers with that
/// one, and with its end as `goal`. Construction takes settings, `history` and these frames, and
/// `snapshot`, a number, or `goal`, which may be a position, too; and `told`, unless the worker is
/// there to look at the past and say nothing (`for_good`). In one of these:
/// - search_method takes `what`, `end`, `now`, `is_first` (search.h);
/// - describe_method takes `what`, cause_method `name`, `since` and `end` (cause.h);
/// - picture_method takes `one`, another picture;
/// - events_method takes `end` and `kinds` (none: all);
/// - trace_method takes `end` and `files` (part_traces.h);
/// - why_method takes `signal` (why.h).
inline constexpr const char* leave_method = "worker.leave";
inline constexpr const char* search_method = "worker.search";
inline constexpr const char* describe_method = "worker.describe";
inline constexpr const char* cause_method = "worker.cause";
inline constexpr const char* picture_method = "worker.picture";
inline constexpr const char* events_method = "worker.events";
inline constexpr const char* trace_method = "worker.trace";
inline constexpr const char* why_method = "worker.why";

/// A *spare* is a worker that has constructed its board, has the history, and simulates nothing. It
/// forks workers that begin there, so that going back constructs no board.
/// - park_method takes settings and `history` with its frames.
/// - fork_method takes `place`, by how many places the new worker's Shared comes after its own, and
///   `first`. That is the call and the parameters of a construction without settings and history,
///   which the new worker answers over its own connection. With `history`, perhaps a newer one,
///   snapshots that the spare has come without a frame. It answers with `process`.
inline constexpr const char* park_method = "worker.park";
inline constexpr const char* fork_method = "worker.fork";

/// The session's end of a worker.
struct WorkerProcess {
  pid_t process = -1;
  host::Descriptor connection;  ///< does not block
  host::Descriptor ends;        ///< of a spare: where it gets its workers' ends of connections
  std::shared_ptr<Shared> shared;

  /// Before the session has a thread. An Error: the system has no process left. `close_others` is
  /// called in the worker: it closes what belongs to the session alone.
  /// `writes_in` as in Door.
  static Result<WorkerProcess> start(SharedPlaces& places,
                                     const std::function<void()>& close_others,
                                     const std::string& writes_in, bool is_spare = false);
  /// Ends it at once. It writes nothing any more.
  void kill() const;
  /// Gives a spare the end of a connection for the next worker that it forks; this one's end. An
  /// Error: the system has none left, or the spare has gone.
  Result<host::Descriptor> connect_next() const;
  /// Stops the call if it is under way, or when it begins.
  void interrupt(uint64_t call) const;
};

}  // namespace capsoc::service
