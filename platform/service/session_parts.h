// What a session keeps of each client and each simulation.
#pragma once

#include <chrono>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host/file_uses.h"
#include "service/session.h"

namespace capsoc::service {

struct Session::Client {
  uint64_t number = 0;
  host::Descriptor input, output;  ///< of a socket `input` alone
  bool is_standard = false;        ///< stdin and stdout, which are never closed
  bool is_authenticated = false, is_gone = false;
  bool is_finished = false;  ///< it sends no more; what it asked for is answered
  MessageReader reader;
  Outbox outbox;
  std::size_t calls = 0;  ///< that workers have not answered

  int write_descriptor() const { return output.valid() ? output.get() : input.get(); }
};

/// What a session knows of a spare (worker.h).
struct Session::Spare {
  uint64_t simulation = 0;                   ///< for which it forks workers
  uint64_t used = 0;                         ///< greater: later
  bool is_ready = false;                     ///< it has constructed its board
  std::vector<uint64_t> known;               ///< serials of the snapshots that it has
  std::deque<host::Descriptor> connections;  ///< to workers that it is about to fork
};

struct Session::Simulation {
  struct Pending {
    uint64_t call;
    std::string method;
    Take take;
  };

  uint64_t number = 0, client = 0;
  Json settings;
  Files files;  ///< that the settings name, of a recorded session; null: none
  std::vector<host::FileUse> outputs;  ///< that the settings name
  uint64_t instead_of = 0;  ///< the simulation whose place it may take, with its outputs; 0: none
  WorkerProcess worker;
  MessageReader reader;
  Outbox outbox;
  std::deque<Pending> pending;
  bool is_constructed = false;
  bool is_ending = false;    ///< what was asked of it is refused
  bool is_replaced = false;  ///< another worker may take its place: later requests wait
  std::deque<Request> waiting;
  uint64_t seeker = 0;              ///< number of a worker that looks into the past for it; 0: none
  bool is_interrupted = false;      ///< the search in the past is to end
  uint64_t spare = 0;               ///< number of the one that forks workers for it; 0: none
  std::unique_ptr<Spare> is_spare;  ///< null: it is a simulation
  std::chrono::steady_clock::time_point deadline;  ///< of one that was closed
};

/// A request that looks into the past, with what the worker left for it.
struct Session::Seek {
  Request request;
  uint64_t simulation = 0, client = 0;
  Json settings, leave, history, told, what;
  Frames frames;
  Position now;
  std::vector<Position> snapshots;
  bool is_whole = false;       ///< `frames` has all snapshots, also those that the spare has
  bool is_known = false;       ///< the spare has this history
  bool may_be_forked = false;  ///< the settings allow a spare
  bool is_alone = false;       ///< a spare has failed: without one
  std::function<void(const Seek& seek, Json hit)> found;

  /// The last snapshot before now.
  std::size_t last() const {
    std::size_t last = 0;
    for (std::size_t i = 1; i < snapshots.size(); ++i)
      if (snapshots[i] < now) last = i;
    return last;
  }
};

}  // namespace capsoc::service
