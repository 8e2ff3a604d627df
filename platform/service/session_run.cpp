#include "service/session_run.h"

#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <string>
#include <utility>

#include "debug/clients.h"
#include "host/console.h"
#include "host/end_signals.h"
#include "results/exit_codes.h"
#include "service/remote_target.h"
#include "service/run_session.h"
#include "service/session_client.h"
#include "service/stop_points.h"

namespace capsoc::service {
namespace {

using debug::Resume;
using debug::StopCause;

constexpr std::chrono::milliseconds nap{50};   ///< with what the program says, while it stands
constexpr std::chrono::milliseconds look{10};  ///< how soon a debugger is heard while it runs
constexpr int looks_a_slice = 5;               ///< then what the program said is shown

class SessionRun final : private debug::Clients::Processor {
 public:
  /// `connections`: null, no debugger can connect. `on_failure`: opened where the run fails; null:
  /// it ends there.
  /// `is_repeated`: of a recorded session.
  SessionRun(RunSession session, std::unique_ptr<debug::Connections> connections, bool halted,
             std::unique_ptr<debug::Connections> on_failure, bool is_repeated)
      : on_failure_(std::move(on_failure)),
        can_be_debugged_(connections != nullptr),
        is_repeated_(is_repeated),
        session_(std::move(session)),
        target_(session_.client(), session_.simulation(),
                [this](const std::string& text) { said_ += text; }),
        clients_(target_, *this, std::move(connections), halted) {}
  SessionRun(const SessionRun&) = delete;
  SessionRun& operator=(const SessionRun&) = delete;

  Json perform() {
    while (host::noted_signal() == 0 && !clients_.is_killed()) {
      clients_.serve();
      if (clients_.is_killed()) break;
      session_.read_keys();
      if (clients_.is_halted())
        clients_.wait(nap);
      else if (!go_on() && !stay())
        break;
    }
    Json finished = session_.finish([this] {
      if (clients_.is_killed()) target_.ask("debugger.kill", Json::object());
    });
    clients_.finish(finished.at("code").get<int>());
    // Killed there, it has failed all the same.
    if (clients_.is_killed() && !failure_.is_null()) finished = failure_;
    if (!failure_.is_null() && finished.value("reports", Json()) == failure_.at("reports"))
      finished["reports"] = Json::array();  // they were shown
    return finished;
  }

 private:
  void debugged(bool on) override {
    // The program can see it: it is an input, once, and what is repeated has its own.
    if (std::exchange(is_attached_, on) != on && !is_repeated_)
      target_.ask("debugger.attach", {{"attached", on}});
  }
  void halted() override {}
  void resumed() override { stood_ = clients_.is_halted(); }

  bool goes_back() const {
    return clients_.how().kind == Resume::Kind::step_back ||
           clients_.how().kind == Resume::Kind::run_back;
  }

  Json request() const {
    const Resume& how = clients_.how();
    Json parameters = {{"simulation", session_.simulation()}, {"points", target_.points()}};
    switch (how.kind) {
      case Resume::Kind::run:
      case Resume::Kind::run_back:
        parameters["kind"] = "run";
        break;
      case Resume::Kind::step:
      case Resume::Kind::step_back:
        parameters["kind"] = "step";
        break;
      case Resume::Kind::range:
        parameters["kind"] = "range";
        parameters["start"] = how.range_start;
        parameters["end"] = how.range_end;
        break;
    }
    if (!goes_back()) parameters["stopped"] = std::exchange(stood_, false);
    return parameters;
  }

  /// Asks, and returns the answer. Interrupts the request when a debugger has sent a packet, or
  /// when output of the program is due to be shown.
  Answer ask_until_wanted(const std::string& method, Json parameters) {
    const uint64_t number = session_.client().send(method, std::move(parameters));
    const bool back = goes_back();
    bool is_interrupted = false;
    for (int looks = 1;; ++looks) {
      if (auto answer = session_.client().wait(number, look)) return std::move(*answer);
      const bool is_due = !back && looks % looks_a_slice == 0;
      if (is_interrupted || !(is_due || clients_.any() || host::noted_signal() != 0)) continue;
      target_.ask("simulation.interrupt", Json::object());
      is_interrupted = true;
    }
  }

  /// No debugger can stop it, and nothing has to be heard where the program sleeps for good.
  bool runs_freely() const { return !can_be_debugged_ && !is_repeated_ && !session_.reads_keys(); }

  Answer run() {
    if (runs_freely())
      return ask_until_wanted("simulation.advance", {{"simulation", session_.simulation()}});
    return ask_until_wanted(goes_back() ? "debugger.reverse" : "debugger.resume", request());
  }

  /// False: the run is over.
  bool go_on() {
    target_.forget();
    clients_.print(std::exchange(said_, {}));  // a console listens only now
    const Answer answer = run();
    session_.show();
    if (!answer.ok()) {
      if (answer.code == Code::over || answer.code == Code::no_simulation) return false;
      clients_.print(answer.sentence + "\n");
      clients_.serve();
      if (!clients_.is_halted()) clients_.halt({StopCause::Kind::interrupted});
      return true;
    }
    const Json& reason = answer.result.at("reason");
    if (reason == Json("over")) return false;
    if (reason == Json("asleep")) {
      if (!clients_.is_debugged() && !session_.reads_keys()) return false;
      clients_.wait(nap);
      return true;
    }
    if (reason == Json("console")) {
      if (is_repeated_) return false;
      session_.answer_console(nap);
      return true;
    }
    if (reason != Json("interrupted")) clients_.halt(cause_in(answer.result));
    return true;
  }

  /// The run is over: true if it failed, and a debugger is to see it where it stands.
  bool stay() {
    if (on_failure_ == nullptr || host::noted_signal() != 0) return false;
    const Answer outcome = session_.ask("simulation.outcome");
    if (!outcome.ok() || outcome.result.at("code") == Json(run::exit_code::pass)) return false;
    failure_ = outcome.result;
    for (const Json& report : failure_.at("reports")) host::say("\n{}", report.get<std::string>());
    host::say(
        "exit {}: {}\ngdb: listening on 127.0.0.1:{}, waiting for a debugger at the failure\n",
        failure_.at("code").get<int>(), failure_.at("reason").get<std::string>(),
        on_failure_->port());
    can_be_debugged_ = true;
    clients_.open(std::move(on_failure_));
    clients_.halt({StopCause::Kind::failure});
    return true;
  }

  std::unique_ptr<debug::Connections> on_failure_;
  bool can_be_debugged_, is_repeated_;
  RunSession session_;
  RemoteTarget target_;
  debug::Clients clients_;
  std::string said_;  ///< for the debugger's console
  Json failure_;      ///< how the run ended that a debugger was to see; null: none did
  bool is_attached_ = false;
  mutable bool stood_ = true;
};

/// Who reads why there is none has asked for one of these.
std::string asked_for_history(const run::RunSettings& settings) {
  for (const IntegerField* field : {&settings.gdb.history_mb, &settings.gdb.on_failure})
    if (!field->is_built_in()) return field->about().name();
  return settings.results.session.about().name();
}

Result<std::unique_ptr<debug::Connections>> listen_at(const IntegerField& port) {
  if (port() < 0) return std::unique_ptr<debug::Connections>();
  return debug::Connections::listen(static_cast<uint16_t>(port()));
}

}  // namespace

Result<Json> run_in_session(const run::RunSettings& settings, const std::string& recorded) {
  host::note_end_signals();
  auto session = RunSession::start(settings, asked_for_history(settings), recorded);
  if (!session) return Error{session.error()};
  if (session.value().is_gone()) return session.value().finish();
  const bool is_halted = settings.gdb.halt();
  if (settings.gdb.port() < 0 && is_halted)
    return Error{"--halt waits for a debugger; give --gdb PORT, too"};
  auto connections = listen_at(settings.gdb.port);
  if (!connections) return Error{connections.error()};
  auto on_failure = listen_at(settings.gdb.on_failure);
  if (!on_failure) return Error{on_failure.error()};
  if (connections.value() != nullptr)
    host::say("gdb: listening on 127.0.0.1:{}{}\n", connections.value()->port(),
              is_halted ? ", waiting for a debugger" : "");
  return SessionRun(std::move(session.value()), std::move(connections.value()), is_halted,
                    std::move(on_failure.value()), !recorded.empty())
      .perform();
}

}  // namespace capsoc::service
