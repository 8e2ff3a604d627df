#include "service/session_run.h"

#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <string>
#include <utility>

#include "debug/clients.h"
#include "host/console.h"
#include "host/end_signals.h"
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
  SessionRun(RunSession session, std::unique_ptr<debug::Connections> connections, bool halted)
      : session_(std::move(session)),
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
      else if (!go_on())
        break;
    }
    Json finished = session_.finish([this] {
      if (clients_.is_killed()) target_.ask("debugger.kill", Json::object());
    });
    clients_.finish(finished.at("code").get<int>());
    return finished;
  }

 private:
  void debugged(bool on) override {
    // The program can see it: it is an input, once.
    if (std::exchange(is_attached_, on) != on) target_.ask("debugger.attach", {{"attached", on}});
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

  /// The answer to a request, which is interrupted when somebody wants something, or when what the
  /// program says is due to be shown.
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

  /// False: the run is over.
  bool go_on() {
    target_.forget();
    clients_.print(std::exchange(said_, {}));  // a console listens only now
    const Answer answer =
        ask_until_wanted(goes_back() ? "debugger.reverse" : "debugger.resume", request());
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
    if (reason != Json("interrupted")) clients_.halt(cause_in(answer.result));
    return true;
  }

  RunSession session_;
  RemoteTarget target_;
  debug::Clients clients_;
  std::string said_;  ///< for the debugger's console
  bool is_attached_ = false;
  mutable bool stood_ = true;
};

/// Who reads why there is none has asked for one of these.
std::string asked_for_history(const run::RunSettings& settings) {
  return settings.gdb.history_mb() > 0 ? settings.gdb.history_mb.about().name()
                                       : settings.results.session.about().name();
}

}  // namespace

Result<Json> run_in_session(const run::RunSettings& settings) {
  host::note_end_signals();
  auto session = RunSession::start(settings, asked_for_history(settings));
  if (!session) return Error{session.error()};
  if (session.value().is_gone()) return session.value().finish();
  std::unique_ptr<debug::Connections> connections;
  const long long port = settings.gdb.port();
  const bool is_halted = settings.gdb.halt();
  if (port < 0 && is_halted) return Error{"--halt waits for a debugger; give --gdb PORT, too"};
  if (port >= 0) {
    auto listening = debug::Connections::listen(static_cast<uint16_t>(port));
    if (!listening) return Error{listening.error()};
    connections = std::move(listening.value());
    host::say("gdb: listening on 127.0.0.1:{}{}\n", connections->port(),
              is_halted ? ", waiting for a debugger" : "");
  }
  return SessionRun(std::move(session.value()), std::move(connections), is_halted).perform();
}

}  // namespace capsoc::service
