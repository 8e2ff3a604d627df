// Going back without constructing a board: a spare (worker.h) of each simulation that has gone back
// once forks its workers in the past.
#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>
#include <set>
#include <utility>

#include "service/session_parts.h"

namespace capsoc::service {
namespace {

/// In a session; of the one that was used least recently its simulation makes another when it goes
/// back.
constexpr std::ptrdiff_t most_spares = 8;

std::vector<uint64_t> serials_in(const Json& history) {
  std::vector<uint64_t> serials;
  for (const Json& each : history.at("snapshots"))
    serials.push_back(each.at("serial").get<uint64_t>());
  return serials;
}

/// What a client knows comes before the history.
Frames frames_before(const Json& history, const Frames& frames) {
  const auto count = history.at("log").get<std::ptrdiff_t>();
  return {frames.begin(), frames.begin() + count};
}

}  // namespace

Session::Simulation* Session::spare_of(uint64_t simulation) {
  const auto owner = simulations_.find(simulation);
  if (owner == simulations_.end()) return nullptr;
  const auto spare = simulations_.find(owner->second->spare);
  return spare == simulations_.end() ? nullptr : spare->second.get();
}

/// By the spare, which is started if there is none; without one where that is not possible.
void Session::start_by_spare(Start start) {
  if (is_refused(start)) return;
  const Seek& seek = *start.seek;
  if (!seek.may_be_forked || seek.is_alone || is_full()) return start_alone(std::move(start));
  Simulation* const spare = spare_of(seek.simulation);
  if (spare != nullptr && spare->is_spare->is_ready) return fork_by_spare(std::move(start), *spare);
  if (!seek.is_whole) return ask_history(std::move(start), &Session::start_by_spare);
  start_spare(std::move(start));
}

/// The spare that had a part of the history has gone.
void Session::ask_history(Start start, void (Session::*then)(Start start)) {
  const std::shared_ptr<Seek> seek = start.seek;
  call(*simulations_.at(seek->simulation), leave_method, seek->leave, {},
       [this, start = std::move(start), then](Answer answer) mutable {
         if (!answer.ok()) return start.done(0, std::move(answer));
         start.seek->history = std::move(answer.result.at("history"));
         start.seek->frames = std::move(answer.frames);
         start.seek->is_whole = true;
         (this->*then)(std::move(start));
       });
}

void Session::start_spare(Start start) {
  const std::shared_ptr<Seek> seek = start.seek;
  Simulation& owner = *simulations_.at(seek->simulation);
  auto worker = make_room_for_spare()
                    ? WorkerProcess::start(places_, close_others(), door_.writes_in, true)
                    : Result<WorkerProcess>(Error{""});
  if (!worker) return start_alone(std::move(start));
  const uint64_t number = next_spare_++;
  auto spare = std::make_unique<Simulation>();
  spare->number = number;
  spare->files = owner.files;
  spare->worker = std::move(worker.value());
  spare->is_spare = std::make_unique<Spare>();
  spare->is_spare->simulation = owner.number;
  spare->is_spare->used = next_use_++;
  owner.spare = number;
  Simulation& added = *(simulations_[number] = std::move(spare));
  call(added, park_method, {{"settings", seek->settings}, {"history", seek->history}}, seek->frames,
       [this, start = std::move(start), number](Answer answer) mutable {
         if (!answer.ok()) return spare_has_failed(std::move(start), std::move(answer));
         Spare& ready = *simulations_.at(number)->is_spare;
         ready.is_ready = true;
         ready.known = serials_in(start.seek->history);
         start.seek->is_known = true;
         start_by_spare(std::move(start));
       });
}

void Session::spare_has_failed(Start start, Answer answer) {
  const auto owner = simulations_.find(start.seek->simulation);
  if (owner == simulations_.end() || owner->second->is_ending)
    return start.done(0, std::move(answer));
  owner->second->spare = 0;
  start.seek->is_alone = true;
  start_alone(std::move(start));
}

void Session::fork_by_spare(Start start, Simulation& spare) {
  auto connection = spare.worker.connect_next();
  std::shared_ptr<Shared> shared = places_.take();
  if (!connection || shared == nullptr) return start_alone(std::move(start));
  const Seek& seek = *start.seek;
  const uint64_t first = next_call_++;
  Json parameters = {{"place", shared.get() - spare.worker.shared.get()},
                     {"first", {{"call", first}, {"params", start.how}}}};
  if (!seek.is_known) parameters["history"] = seek.history;
  spare.is_spare->used = next_use_++;
  spare.is_spare->connections.push_back(std::move(connection.value()));
  Frames frames = seek.is_known ? frames_before(seek.history, seek.frames) : seek.frames;
  call(spare, fork_method, std::move(parameters), std::move(frames),
       [this, start = std::move(start), shared, number = spare.number,
        first](Answer answer) mutable {
         if (!answer.ok()) return spare_has_failed(std::move(start), std::move(answer));
         Spare& forked = *simulations_.at(number)->is_spare;
         WorkerProcess worker;
         worker.process = answer.result.at("process").get<pid_t>();
         worker.connection = std::move(forked.connections.front());
         worker.shared = std::move(shared);
         forked.connections.pop_front();
         forked.known = serials_in(start.seek->history);
         start.seek->is_known = true;
         take_fork(std::move(start), std::move(worker), first);
       });
}

/// It has begun with its first call.
void Session::take_fork(Start start, WorkerProcess worker, uint64_t first) {
  const Seek& seek = *start.seek;
  const uint64_t number = next_simulation_++;
  auto simulation = std::make_unique<Simulation>();
  simulation->number = number;
  simulation->client = start.client;
  simulation->settings = seek.settings;
  simulation->worker = std::move(worker);
  Simulation& added = *(simulations_[number] = std::move(simulation));
  if (is_refused(start)) return drop_worker(number);
  Simulation& owner = *simulations_.at(seek.simulation);
  owner.seeker = number;
  added.files = owner.files;
  added.outputs = owner.outputs;
  added.instead_of = owner.number;
  added.pending.push_back(
      {first, construct_method, when_constructed(number, std::move(start.done))});
}

/// It was to fork a worker, of which this process does not know whether it is there.
bool Session::was_forking(const Simulation& simulation) {
  return simulation.is_spare != nullptr && !simulation.is_spare->connections.empty();
}

/// Workers of spares that were killed before they told of them.
void Session::end_strays() {
  std::set<pid_t> known;
  for (const auto& [number, each] : simulations_) known.insert(each->worker.process);
  for (const auto& each : ending_) known.insert(each->worker.process);
  std::ifstream children("/proc/thread-self/children");
  for (pid_t process = 0; children >> process;) {
    if (known.count(process) > 0) continue;
    kill(process, SIGKILL);
    waitpid(process, nullptr, 0);
  }
}

/// False: all are in use.
bool Session::make_room_for_spare() {
  const auto first = simulations_.lower_bound(first_spare);
  if (std::distance(first, simulations_.end()) < most_spares) return true;
  Simulation* least = nullptr;
  for (auto at = first; at != simulations_.end(); ++at) {
    const auto owner = simulations_.find(at->second->is_spare->simulation);
    if (owner != simulations_.end() && owner->second->is_replaced) continue;
    if (least == nullptr || at->second->is_spare->used < least->is_spare->used)
      least = at->second.get();
  }
  if (least == nullptr) return false;
  drop_worker(least->number);
  return true;
}

}  // namespace capsoc::service
