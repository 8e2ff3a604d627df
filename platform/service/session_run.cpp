#include "service/session_run.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "debug/clients.h"
#include "host/console.h"
#include "host/end_signals.h"
#include "results/results.h"
#include "service/remote_target.h"
#include "service/session_client.h"
#include "service/stop_points.h"

namespace capsoc::service {
namespace {

using debug::Resume;
using debug::StopCause;

constexpr std::chrono::milliseconds nap{50};   ///< with what the program says, while it stands
constexpr std::chrono::milliseconds look{10};  ///< how soon a debugger is heard while it runs
constexpr int looks_a_slice = 5;               ///< then what the program said is shown

/// A stream of the program that the terminal shows.
struct Shown {
  std::string method;
  Json parameters;
  bool on_stderr;
};

/// What a session is given of the settings of a run, and what is left for the terminal.
struct Divided {
  Json settings = Json::object();
  std::vector<Shown> shown;
  std::string session_file;  ///< "": none
  int keyboard = -1;         ///< the UART that reads standard input; -1: none
};

Divided divide(const run::RunSettings& settings) {
  Divided divided;
  divided.session_file = settings.results.session();
  for (const Setting& setting : settings.all())
    if (setting.source != SettingSource::built_in) divided.settings[setting.path] = setting.value;
  for (const Setting& own : {settings.gdb.port.about(), settings.gdb.halt.about(),
                             settings.gdb.history_mb.about(), settings.results.json.about(),
                             settings.results.html.about(), settings.results.session.about()})
    divided.settings.erase(own.path);
  if (settings.gdb.history_mb() > 0)
    divided.settings["history_mb"] = static_cast<uint64_t>(settings.gdb.history_mb());
  if (settings.results.wants_curves())
    divided.settings[settings.results.curves.about().path] = "true";
  for (std::size_t n = 0; n < settings.uarts.lines.size(); ++n) {
    const TextField& place = settings.uarts.lines[n].backend;
    const std::string at = place();
    if (at != "stdout" && at != "stdio" && at != "stderr") continue;
    divided.settings[place.about().path] = "null";
    divided.shown.push_back({"uart.read", {{"uart", n}, {"raw", true}}, at == "stderr"});
    if (at == "stdio") divided.keyboard = static_cast<int>(n);
  }
  if (settings.itm.backend() == "stdout")
    divided.shown.push_back({"itm.read", {{"raw", true}}, false});
  const std::string console = settings.semihosting.console();
  if (console == "stdout" || console == "stdio" || console == "stderr")
    divided.shown.push_back({"semihosting.read", {{"raw", true}}, console == "stderr"});
  return divided;
}

/// Whoever ended the simulation's process: it did not end well.
Json ended_badly(const Answer& refusal) {
  return {{"code", run::exit_code::internal}, {"lost", {refusal.sentence}}};
}

class SessionRun final : private debug::Clients::Processor {
 public:
  SessionRun(SessionClient& session, uint64_t simulation, Divided divided,
             std::unique_ptr<debug::Connections> connections, bool halted)
      : session_(session),
        simulation_(simulation),
        shown_(std::move(divided.shown)),
        session_file_(std::move(divided.session_file)),
        keyboard_(divided.keyboard),
        target_(session, simulation, [this](const std::string& text) { said_ += text; }),
        clients_(target_, *this, std::move(connections), halted) {}
  SessionRun(const SessionRun&) = delete;
  SessionRun& operator=(const SessionRun&) = delete;

  Json perform() {
    while (host::noted_signal() == 0 && !clients_.is_killed()) {
      clients_.serve();
      if (clients_.is_killed()) break;
      read_keys();
      if (clients_.is_halted())
        clients_.wait(nap);
      else if (!go_on())
        break;
    }
    record();
    if (clients_.is_killed()) target_.ask("debugger.kill", Json::object());
    const Answer answer = target_.ask("simulation.finish", Json::object());
    show();
    Json finished = answer.result;
    if (!answer.ok()) finished = ended_badly(answer);
    if (bytes_lost_ > 0)
      lost_.push_back(
          fmt::format("{} bytes that the program said were too many to be shown", bytes_lost_));
    for (const std::string& sentence : lost_) finished["lost"].push_back(sentence);
    if (!lost_.empty() && finished["code"] == Json(run::exit_code::pass))
      finished["code"] = run::exit_code::lost;
    clients_.finish(finished.at("code").get<int>());
    return finished;
  }

 private:
  void record() {
    if (session_file_.empty()) return;
    const Answer answer = target_.ask("simulation.record", {{"file", session_file_}});
    if (!answer.ok()) lost_.push_back(answer.sentence);
  }

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
    Json parameters = {{"simulation", simulation_}, {"points", target_.points()}};
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
    const uint64_t number = session_.send(method, std::move(parameters));
    const bool back = goes_back();
    bool is_interrupted = false;
    for (int looks = 1;; ++looks) {
      if (auto answer = session_.wait(number, look)) return std::move(*answer);
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
    show();
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
      if (!clients_.is_debugged() && keyboard_ < 0) return false;
      clients_.wait(nap);
      return true;
    }
    if (reason != Json("interrupted")) clients_.halt(cause_in(answer.result));
    return true;
  }

  void show() {
    for (const Shown& each : shown_) {
      const Answer answer = target_.ask(each.method, each.parameters);
      if (!answer.ok()) continue;
      bytes_lost_ += answer.result.at("lost").get<uint64_t>();
      const std::string text = bytes_in(answer.result.at("text"), answer.frames);
      if (text.empty()) continue;
      if (each.on_stderr)
        host::say(std::string_view(text));
      else
        host::print(std::string_view(text));
    }
  }

  void read_keys() {
    if (keyboard_ < 0) return;
    pollfd keys{STDIN_FILENO, POLLIN, 0};
    if (poll(&keys, 1, 0) <= 0) return;
    char buffer[4096];
    const ssize_t count = read(STDIN_FILENO, buffer, sizeof buffer);
    if (count <= 0) {
      keyboard_ = -1;
      return;
    }
    Json bytes = Json::array();
    for (ssize_t i = 0; i < count; ++i) bytes.push_back(static_cast<uint8_t>(buffer[i]));
    target_.ask("uart.send", {{"uart", keyboard_}, {"bytes", std::move(bytes)}});
  }

  SessionClient& session_;
  uint64_t simulation_;
  std::vector<Shown> shown_;
  std::string session_file_;
  int keyboard_;
  RemoteTarget target_;
  debug::Clients clients_;
  std::string said_;               ///< for the debugger's console
  std::vector<std::string> lost_;  ///< a sentence for each output that is not whole
  uint64_t bytes_lost_ = 0;
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
  if (settings.semihosting.console() == "stdio")
    return Error{fmt::format(
        "{}: stdio reads standard input when the program asks, which {} cannot repeat; take stderr "
        "or stdout",
        settings.semihosting.console.about().name(), asked_for_history(settings))};
  host::note_end_signals();
  auto session = ChildSession::start();
  if (!session) return Error{session.error()};
  SessionClient& client = session.value().client();
  Divided divided = divide(settings);
  const Answer constructed = client.call("simulation.construct", {{"settings", divided.settings}});
  if (constructed.code == Code::no_simulation) return ended_badly(constructed);
  if (!constructed.ok()) return Error{constructed.sentence};
  const uint64_t simulation = constructed.result.at("simulation").get<uint64_t>();
  const Answer history = client.call("history.when", {{"simulation", simulation}});
  if (history.ok() && !history.result.at("kept").get<bool>())
    return Error{fmt::format("{}: there is no history: {}", asked_for_history(settings),
                             history.result.at("why").get<std::string>())};
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
  return SessionRun(client, simulation, std::move(divided), std::move(connections), is_halted)
      .perform();
}

}  // namespace capsoc::service
