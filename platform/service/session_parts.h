// What a session keeps of each client and each simulation.
#pragma once

#include <chrono>
#include <deque>
#include <string>
#include <utility>

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

struct Session::Simulation {
  struct Pending {
    uint64_t call;
    std::string method;
    Take take;
  };

  uint64_t number = 0, client = 0;
  Json settings;
  Files files;  ///< that the settings name, of a recorded session; null: none
  WorkerProcess worker;
  MessageReader reader;
  Outbox outbox;
  std::deque<Pending> pending;
  bool is_constructed = false;
  bool is_replaced = false;  ///< another worker may take its place: later requests wait
  std::deque<Request> waiting;
  uint64_t seeker = 0;          ///< number of a worker that looks into the past for it; 0: none
  bool is_interrupted = false;  ///< the search in the past is to end
  std::chrono::steady_clock::time_point deadline;  ///< of one that was closed
};

}  // namespace capsoc::service
