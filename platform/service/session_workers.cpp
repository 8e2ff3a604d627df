// The session's side of its workers.
#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <iterator>
#include <utility>

#include "base/printable.h"
#include "service/outputs.h"
#include "service/session_parts.h"

namespace capsoc::service {
namespace {

constexpr std::size_t most_simulations = 1000;
/// For a closed simulation to write its outputs.
constexpr std::chrono::seconds patience{10};

std::string ending_of(int status) {
  if (WIFSIGNALED(status)) return fmt::format("was ended by signal {}", WTERMSIG(status));
  if (WIFEXITED(status) && WEXITSTATUS(status) == out_of_memory) return "ran out of memory";
  return fmt::format("ended by itself with code {}", WIFEXITED(status) ? WEXITSTATUS(status) : -1);
}

}  // namespace

void Session::start(uint64_t client, const Snapshot& from, Constructed done, uint64_t instead_of) {
  start_with(client, from.settings, {{"held", from.held}}, from.frames, from.files, std::move(done),
             instead_of);
}

void Session::start_with(uint64_t client, Json settings, Json parameters, Frames frames,
                         Files files, Constructed done, uint64_t instead_of) {
  if (is_full())
    return done(
        0, refuse(fmt::format("there are {} simulations already; close one", most_simulations)));
  std::vector<host::FileUse> outputs = outputs_of(settings);
  if (auto error = check_outputs(outputs, instead_of)) return done(0, refuse(error->text));
  auto worker = WorkerProcess::start(places_, close_others(), door_.writes_in);
  if (!worker) return done(0, refuse(worker.error()));
  const uint64_t number = next_simulation_++;
  auto simulation = std::make_unique<Simulation>();
  simulation->number = number;
  simulation->client = client;
  simulation->settings = settings;
  simulation->files = std::move(files);
  simulation->outputs = std::move(outputs);
  simulation->instead_of = instead_of;
  simulation->worker = std::move(worker.value());
  Simulation& added = *(simulations_[number] = std::move(simulation));
  parameters["settings"] = std::move(settings);
  call(added, construct_method, std::move(parameters), std::move(frames),
       when_constructed(number, std::move(done)));
}

/// An Error if one is that of another simulation.
std::optional<Error> Session::check_outputs(const std::vector<host::FileUse>& outputs,
                                            uint64_t instead_of) const {
  for (const auto& [number, other] : simulations_) {
    const bool is_same = number == instead_of || other->instead_of == instead_of;
    if (instead_of != 0 && is_same) continue;
    if (const host::FileUse* const use = host::shared_output(outputs, other->outputs))
      return Error{
          fmt::format("{}: {} is a file that simulation {} writes; name another one, or close "
                      "that simulation first",
                      use->name, printable(use->path, 200), number)};
  }
  return std::nullopt;
}

/// Of simulations and those that are on their way out, without spares.
bool Session::is_full() const {
  const auto is_counted = [](const auto& each) { return each->is_spare == nullptr; };
  const auto spares = std::distance(simulations_.lower_bound(first_spare), simulations_.end());
  const auto ending = std::count_if(ending_.begin(), ending_.end(), is_counted);
  return simulations_.size() - static_cast<std::size_t>(spares) +
             static_cast<std::size_t>(ending) >=
         most_simulations;
}

/// In a new worker: descriptors of the session; that of the worker is closed by itself.
std::function<void()> Session::close_others() {
  const auto close = [](Simulation& each) {
    each.worker.connection.reset();
    each.worker.ends.reset();
    if (each.is_spare != nullptr) each.is_spare->connections.clear();
  };
  return [this, close] {
    for (auto& [number, each] : clients_)
      if (!each->is_standard) each->input.reset();
    for (auto& [number, each] : simulations_) close(*each);
    for (auto& each : ending_) close(*each);
    door_.listener.reset();
  };
}

Session::Take Session::when_constructed(uint64_t number, Constructed done) {
  return [this, number, done = std::move(done)](Answer answer) {
    const auto found = simulations_.find(number);
    if (answer.ok() && found != simulations_.end()) {
      found->second->is_constructed = true;
    } else if (found != simulations_.end()) {
      ended_[number] = "was not constructed";
      end_worker(*found->second);
      refuse_pending(*found->second, fmt::format("simulation {} was not constructed", number));
      ending_.push_back(std::move(found->second));
      simulations_.erase(found);
    }
    done(number, std::move(answer));
  };
}

void Session::call(Simulation& simulation, const std::string& method, Json parameters,
                   Frames frames, Take take, const Json& id) {
  const uint64_t number = next_call_++;
  Message message;
  message.body = {{"call", number}, {"method", method}, {"params", std::move(parameters)}};
  if (!id.is_discarded()) message.body["id"] = id;
  message.frames = std::move(frames);
  simulation.pending.push_back({number, method, std::move(take)});
  simulation.outbox.add(to_bytes(message));
}

void Session::take_snapshot(Simulation& simulation, Taken taken) {
  call(simulation, snapshot_method, Json::object(), {},
       [settings = simulation.settings, files = simulation.files,
        taken = std::move(taken)](Answer answer) {
         if (!answer.ok() || answer.frames.empty()) return taken(std::nullopt, std::move(answer));
         taken(Snapshot{settings, std::move(answer.result.at("held")), std::move(answer.frames),
                        files},
               {});
       });
}

/// It writes its outputs and ends; an advance under way is stopped.
void Session::end_worker(Simulation& simulation) {
  simulation.deadline = std::chrono::steady_clock::now() + patience;
  if (!simulation.pending.empty()) simulation.worker.interrupt(simulation.pending.front().call);
  if (simulation.worker.connection.valid()) shutdown(simulation.worker.connection.get(), SHUT_RDWR);
}

/// Of a client. What was asked of it is refused.
void Session::end_simulation(uint64_t number, const std::string& why) {
  Simulation& simulation = *simulations_.at(number);
  end_worker(simulation);
  refuse_pending(simulation, fmt::format("simulation {} {}", number, why));
  ended_[number] = why;
  // A construction that was under way has taken it out itself.
  const auto found = simulations_.find(number);
  if (found == simulations_.end()) return;
  ending_.push_back(std::move(found->second));
  simulations_.erase(found);
}

void Session::reap() {
  bool has_strays = false;
  for (auto at = ending_.begin(); at != ending_.end();) {
    const pid_t process = (*at)->worker.process;
    if (std::chrono::steady_clock::now() > (*at)->deadline) kill(process, SIGKILL);
    int status = 0;
    if (waitpid(process, &status, WNOHANG) != process) {
      ++at;
      continue;
    }
    has_strays = has_strays || was_forking(**at);
    at = ending_.erase(at);
  }
  std::vector<uint64_t> gone, left;
  for (auto& [number, simulation] : simulations_)
    if (!simulation->worker.connection.valid())
      gone.push_back(number);
    else if (simulation->is_spare != nullptr &&
             spare_of(simulation->is_spare->simulation) != simulation.get())
      left.push_back(number);
  // A spare ends with its simulation.
  for (const uint64_t number : left) drop_worker(number);
  for (const uint64_t number : gone) {
    const auto found = simulations_.find(number);
    if (found == simulations_.end()) continue;  // it was dropped with another one
    int status = 0;
    // It has closed its connection and has nothing left to do.
    kill(found->second->worker.process, SIGKILL);
    waitpid(found->second->worker.process, &status, 0);
    const std::unique_ptr<Simulation> simulation = std::move(found->second);
    simulations_.erase(found);
    has_strays = has_strays || was_forking(*simulation);
    worker_is_gone(*simulation, status);
  }
  if (has_strays) end_strays();
}

void Session::worker_is_gone(Simulation& simulation, int status) {
  if (simulation.is_spare == nullptr) ended_[simulation.number] = ending_of(status);
  const std::string sentence =
      fmt::format("simulation {} {}; the others continue", simulation.number, ending_of(status));
  refuse_pending(simulation, sentence);
}

/// Answers what a worker will not.
void Session::refuse_pending(Simulation& simulation, const std::string& sentence) {
  simulation.is_ending = true;
  while (!simulation.pending.empty()) {
    const Take take = std::move(simulation.pending.front().take);
    simulation.pending.pop_front();
    take(refuse(sentence, Code::no_simulation));
  }
  for (const Request& request : std::exchange(simulation.waiting, {}))
    settle(request, refuse(sentence, Code::no_simulation));
  // The worker that searches its past, or is about to fork one, has no simulation left to report
  // to.
  for (const uint64_t other :
       {std::exchange(simulation.seeker, 0), std::exchange(simulation.spare, 0)}) {
    const auto found = simulations_.find(other);
    if (found == simulations_.end()) continue;
    refuse_pending(*found->second, sentence);
    drop_worker(other);
  }
}

}  // namespace capsoc::service
