// The methods of the session itself.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "host/end_signals.h"
#include "service/board_verbs.h"
#include "service/recording.h"
#include "service/session_parts.h"
#include "version/version.h"

namespace capsoc::service {
namespace {

constexpr int protocol = 1;
constexpr uint64_t most_clones = 1000;
constexpr std::size_t most_snapshots = 10'000;

/// Equal whatever part of them is not: takes as much time for each.
bool is_same(const std::string& one, const std::string& other) {
  if (one.size() != other.size()) return false;
  unsigned differ = 0;
  for (std::size_t i = 0; i < one.size(); ++i) differ |= static_cast<unsigned>(one[i] ^ other[i]);
  return differ == 0;
}

Parameter number_of(const char* what) {
  return need(what, Type::integer, "its number");
}

}  // namespace

const std::vector<Session::SessionVerb>& Session::verbs() {
  static const std::vector<SessionVerb> all = [] {
    std::vector<SessionVerb> verbs = own_verbs();
    for (SessionVerb& verb : history_verbs()) verbs.push_back(std::move(verb));
    return verbs;
  }();
  return all;
}

std::vector<Session::SessionVerb> Session::own_verbs() {
  return {
      {{"session.about",
        "Who answers.",
        {},
        {{"version", "text", "of capsoc"},
         {"commit", "text", "that it was made from"},
         {"protocol", "integer", "1; another number is another protocol"}}},
       false,
       &Session::about},
      {{"session.schema",
        "All methods with their parameters and results: what this page is made from.",
        {},
        {{"methods", "list", "of objects: name, text, simulation, params, result"}}},
       false,
       &Session::tell_schema},
      {{"session.authenticate",
        "Shows the token of a session that was started with --port, before anything else.",
        {need("token", Type::text, "as it was printed")},
        {}},
       false,
       &Session::authenticate},
      {{"session.simulations",
        "What there is.",
        {},
        {{"simulations", "list", "of objects: simulation, process, program"}}},
       false,
       &Session::list},
      {{"session.end", "Closes all simulations and ends the session.", {}, {}},
       false,
       &Session::end},
      {{"simulation.construct",
        "Builds the board with its program and its sensor, in reset, in its own process. It "
        "is closed when the client that asked for it leaves.",
        {may("settings", Type::object,
             "names and values as `capsoc run -C` takes them; firmware.elf may be the name of a "
             "program that comes with capsoc; history_mb (64): memory for going back, 0: none is "
             "kept"),
         may("session", Type::text,
             "a file that simulation.record wrote: its settings, those given here over them, and "
             "its inputs, each of which comes at its instant; history.when tells its end")},
        {{"simulation", "integer", "its number"}, {"state", "object", "as simulation.state"}}},
       false,
       &Session::construct},
      {{"simulation.close", "Ends it. Its outputs are written.", {}, {}}, true, &Session::close},
      {{"simulation.interrupt",
        "Stops an advance that is under way at its next instruction; that answers with the reason "
        "`interrupted`. When that is depends on the host.",
        {},
        {}},
       true,
       &Session::interrupt},
      {{"simulation.snapshot",
        "Keeps the state of now in the session's memory.",
        {},
        {{"snapshot", "integer", "its number"}, {"bytes", "integer", "that it takes"}}},
       true,
       &Session::snapshot},
      {{"simulation.restore",
        "Takes a simulation back to a snapshot, its own or another's. Samples from before the "
        "snapshot are not kept.",
        {number_of("snapshot")},
        {{"state", "object", "as simulation.state"}}},
       true,
       &Session::restore},
      {{"simulation.clone",
        "Further simulations in the state of this one.",
        {may("count", Type::integer, "how many, 1")},
        {{"simulations", "list", "their numbers"}}},
       true,
       &Session::clone},
      {{"snapshot.drop", "Forgets a snapshot.", {number_of("snapshot")}, {}},
       false,
       &Session::drop},
  };
}

Json Session::schema() {
  Json methods = Json::array();
  for (const SessionVerb& verb : verbs())
    methods.push_back(schema_of(verb.about, verb.of_simulation));
  for (const BoardVerb& verb : board_verbs()) methods.push_back(schema_of(verb.about, true));
  return {{"protocol", protocol}, {"methods", std::move(methods)}};
}

void Session::about(Request& request) {
  Answer told;
  told.result = {{"version", version()}, {"commit", commit()}, {"protocol", protocol}};
  answer(request, std::move(told));
}

void Session::tell_schema(Request& request) {
  Answer told;
  told.result = schema();
  answer(request, std::move(told));
}

void Session::authenticate(Request& request) {
  Client& client = *clients_.at(request.client);
  client.is_authenticated = client.is_authenticated ||
                            is_same(request.parameters.at("token").get<std::string>(), door_.token);
  if (client.is_authenticated) return answer(request, {});
  answer(request, refuse("this is not the token; it stands on the session's standard error"));
  client.is_finished = true;
}

void Session::list(Request& request) {
  Answer told;
  Json& list = told.result["simulations"] = Json::array();
  for (const auto& [number, each] : simulations_)
    if (each->is_constructed)
      list.push_back({{"simulation", number},
                      {"process", each->worker.process},
                      {"program", each->settings.value("firmware.elf", Json("selfcal"))}});
  answer(request, std::move(told));
}

void Session::end(Request& request) {
  answer(request, {});
  is_ending_ = true;
}

void Session::construct(Request& request) {
  Json settings = request.parameters.value("settings", Json::object());
  Json parameters = Json::object();
  Frames frames;
  Files files;
  if (const auto file = request.parameters.find("session"); file != request.parameters.end()) {
    const auto session = read_session(file->get<std::string>());
    if (!session) return answer(request, refuse(session.error()));
    auto laid = lay_out(session.value());
    if (!laid)
      return answer(request, refuse(fmt::format("{}: {}", file->get<std::string>(), laid.error())));
    Repetition& repeated = laid.value();
    repeated.settings.update(settings);
    settings = std::move(repeated.settings);
    parameters["expected"] = {{"end", to_json(repeated.end)}};
    frames.emplace_back();
    for (const Input& input : repeated.inputs) frames.back() += to_bytes(input);
    frames.push_back(std::move(repeated.state));
    files = std::move(repeated.folder);
  }
  ++clients_.at(request.client)->calls;
  start_with(request.client, std::move(settings), std::move(parameters), std::move(frames),
             std::move(files), [this, request](uint64_t number, Answer constructed) {
               if (constructed.ok()) {
                 Json state = std::move(constructed.result.at("state"));
                 constructed.result = {{"simulation", number}, {"state", std::move(state)}};
               }
               settle(request, std::move(constructed));
             });
}

/// Answers a request that a worker had to do with.
void Session::settle(const Request& request, Answer final_answer) {
  if (const auto client = clients_.find(request.client); client != clients_.end())
    --client->second->calls;
  answer(request, std::move(final_answer));
}

Session::Simulation* Session::simulation_of(const Request& request) {
  const auto given = request.parameters.find("simulation");
  if (given == request.parameters.end() || !given->is_number_unsigned()) {
    answer(request, refuse(request.method + ": the parameter 'simulation' has to be the number of "
                                            "a simulation",
                           Code::wrong_parameter));
    return nullptr;
  }
  const auto number = given->get<uint64_t>();
  const auto found = simulations_.find(number);
  // The client that created it need not wait for the construction.
  if (found != simulations_.end() &&
      (found->second->is_constructed || found->second->client == request.client))
    return found->second.get();
  const auto ended = ended_.find(number);
  answer(request,
         refuse(ended == ended_.end() ? fmt::format("there is no simulation {}", number)
                                      : fmt::format("simulation {} {}", number, ended->second),
                Code::no_simulation));
  return nullptr;
}

void Session::forward(Request& request) {
  Simulation* const simulation = simulation_of(request);
  if (simulation == nullptr) return;
  ++clients_.at(request.client)->calls;
  hand_on(*simulation, request);
}

/// Requests that waited for a simulation to be replaced, in their order.
void Session::resume(std::deque<Request> waiting) {
  for (Request& each : waiting) {
    const auto client = clients_.find(each.client);
    if (client == clients_.end()) continue;
    --client->second->calls;
    perform(each);
  }
}

void Session::hand_on(Simulation& simulation, Request& request) {
  Json parameters = std::move(request.parameters);
  Frames frames = std::move(request.frames);
  call(
      simulation, request.method, std::move(parameters), std::move(frames),
      [this, client = request.client, id = request.id](Answer came) {
        if (id.is_discarded() || !came.ok())
          return settle({client, id, {}, {}, {}}, std::move(came));
        const auto found = clients_.find(client);
        if (found == clients_.end()) return;
        --found->second->calls;
        if (!found->second->is_gone) found->second->outbox.add(std::move(came.frames.at(0)));
      },
      request.id);
}

void Session::close(Request& request) {
  Simulation* const simulation = simulation_of(request);
  if (simulation == nullptr) return;
  end_simulation(simulation->number, "was closed");
  answer(request, {});
}

void Session::interrupt(Request& request) {
  Simulation* const simulation = simulation_of(request);
  if (simulation == nullptr) return;
  if (!simulation->pending.empty()) simulation->worker.interrupt(simulation->pending.front().call);
  simulation->is_interrupted = true;
  const auto seeker = simulations_.find(simulation->seeker);
  if (seeker != simulations_.end() && !seeker->second->pending.empty())
    seeker->second->worker.interrupt(seeker->second->pending.front().call);
  answer(request, {});
}

void Session::snapshot(Request& request) {
  Simulation* const simulation = simulation_of(request);
  if (simulation == nullptr) return;
  if (snapshots_.size() >= most_snapshots)
    return answer(request,
                  refuse(fmt::format("there are {} snapshots already; drop one", most_snapshots)));
  ++clients_.at(request.client)->calls;
  take_snapshot(*simulation, [this, request](std::optional<Snapshot> taken, Answer refusal) {
    if (!taken) return settle(request, std::move(refusal));
    const uint64_t number = next_snapshot_++;
    Answer told;
    std::size_t bytes = 0;
    for (const std::string& frame : taken->frames) bytes += frame.size();
    told.result = {{"snapshot", number}, {"bytes", bytes}};
    snapshots_[number] = std::make_shared<const Snapshot>(std::move(*taken));
    settle(request, std::move(told));
  });
}

/// A new worker takes the place of the old one.
void Session::restore(Request& request) {
  Simulation* const simulation = simulation_of(request);
  if (simulation == nullptr) return;
  const auto number = request.parameters.at("snapshot").get<uint64_t>();
  const auto found = snapshots_.find(number);
  if (found == snapshots_.end())
    return answer(request, refuse(fmt::format("there is no snapshot {}", number)));
  ++clients_.at(request.client)->calls;
  simulation->is_replaced = true;
  start(
      simulation->client, *found->second,
      [this, request, old = simulation->number](uint64_t fresh, Answer constructed) {
        finish_restore(request, old, fresh, std::move(constructed));
      },
      simulation->number);
}

void Session::finish_restore(const Request& request, uint64_t number, uint64_t fresh,
                             Answer constructed) {
  const auto found = simulations_.find(number);
  if (found == simulations_.end()) {
    drop_worker(fresh);
    return settle(request, refuse(fmt::format("simulation {} has ended meanwhile", number),
                                  Code::no_simulation));
  }
  std::deque<Request> waiting = std::exchange(found->second->waiting, {});
  found->second->is_replaced = false;
  found->second->seeker = 0;
  if (constructed.ok()) {
    std::unique_ptr<Simulation> replacement = std::move(simulations_.at(fresh));
    simulations_.erase(fresh);
    replacement->number = number;
    replacement->instead_of = 0;
    replacement->is_constructed = true;
    if (request.method == "simulation.restore") {
      end_worker(*found->second);  // its spare, too, which does not know the new history
    } else {
      replacement->spare = found->second->spare;
      found->second->worker.kill();  // it has no outputs
    }
    ending_.push_back(std::exchange(found->second, std::move(replacement)));
  }
  settle(request, std::move(constructed));
  resume(std::move(waiting));
}

void Session::clone(Request& request) {
  Simulation* const simulation = simulation_of(request);
  if (simulation == nullptr) return;
  const uint64_t count = request.parameters.value("count", uint64_t{1});
  if (count == 0 || count > most_clones)
    return answer(request,
                  refuse(fmt::format("count: give 1 to {}", most_clones), Code::wrong_parameter));
  ++clients_.at(request.client)->calls;
  take_snapshot(*simulation, [this, request, count](std::optional<Snapshot> taken, Answer refusal) {
    if (!taken) return settle(request, std::move(refusal));
    auto family = std::make_shared<Family>();
    family->left = count;
    const Snapshot from = std::move(*taken);
    for (uint64_t i = 0; i < count; ++i)
      start(request.client, from, [this, request, family](uint64_t number, Answer constructed) {
        if (constructed.ok())
          family->numbers.push_back(number);
        else
          family->refusal = std::move(constructed);
        if (--family->left == 0) finish_clone(request, *family);
      });
  });
}

/// All of them, or none.
void Session::finish_clone(const Request& request, Family& family) {
  if (family.refusal.ok()) {
    std::sort(family.numbers.begin(), family.numbers.end());
    Answer told;
    told.result["simulations"] = family.numbers;
    return settle(request, std::move(told));
  }
  for (const uint64_t number : family.numbers) {
    const auto found = simulations_.find(number);
    if (found == simulations_.end()) continue;
    end_worker(*found->second);
    ending_.push_back(std::move(found->second));
    simulations_.erase(found);
  }
  settle(request, std::move(family.refusal));
}

void Session::drop(Request& request) {
  const auto number = request.parameters.at("snapshot").get<uint64_t>();
  if (snapshots_.erase(number) == 0)
    return answer(request, refuse(fmt::format("there is no snapshot {}", number)));
  answer(request, {});
}

}  // namespace capsoc::service
