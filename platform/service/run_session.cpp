#include "service/run_session.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <optional>
#include <string_view>
#include <utility>

#include "host/console.h"
#include "results/results.h"

namespace capsoc::service {
namespace {

/// Result of a run whose simulation process is gone, for any reason.
Json ended_badly(const Answer& refusal) {
  return {{"code", run::exit_code::internal}, {"lost", {refusal.sentence}}};
}

Json array_of(std::string_view bytes) {
  Json array = Json::array();
  for (const char byte : bytes) array.push_back(static_cast<uint8_t>(byte));
  return array;
}

}  // namespace

Json RunSession::settings_of(const run::RunSettings& settings) {
  Json given = Json::object();
  for (const Setting& setting : settings.all())
    if (setting.source != SettingSource::built_in) given[setting.path] = setting.value;
  for (const Setting& own :
       {settings.gdb.port.about(), settings.gdb.halt.about(), settings.gdb.history_mb.about(),
        settings.gdb.on_failure.about(), settings.results.json.about(),
        settings.results.html.about(), settings.results.session.about(),
        settings.results.keep_last_s.about(), settings.view.port.about()})
    given.erase(own.path);
  // A page paces the run itself.
  if (settings.view.port() >= 0) given.erase(settings.limits.realtime.about().path);
  if (settings.gdb.memory_mb() > 0)
    given["history_mb"] = static_cast<uint64_t>(settings.gdb.memory_mb());
  if (settings.results.wants_curves()) given[settings.results.curves.about().path] = "true";
  for (const run::UartSettings::Line& line : settings.uarts.lines)
    if (place_of(line.backend()) != Stream::Place::nowhere)
      given[line.backend.about().path] = "null";
  return given;
}

RunSession::Stream::Place RunSession::place_of(const std::string& backend) {
  if (backend == "stderr") return Stream::Place::error;
  return backend == "stdout" || backend == "stdio" ? Stream::Place::output : Stream::Place::nowhere;
}

/// What the session is given of the settings, and what is left for the terminal.
void RunSession::divide(const run::RunSettings& settings) {
  session_file_ = settings.results.session();
  keep_last_s_ = settings.results.keep_last_s();
  settings_ = settings_of(settings);
  for (std::size_t n = 0; n < settings.uarts.lines.size(); ++n) {
    const TextField& backend = settings.uarts.lines[n].backend;
    streams_.push_back(
        {fmt::format("uart{}", n), "uart.read", {{"uart", n}, {"raw", true}}, place_of(backend())});
    if (backend() == "stdio") keyboard_ = static_cast<int>(n);
  }
  streams_.push_back({"itm", "itm.read", {{"raw", true}}, place_of(settings.itm.backend())});
  streams_.push_back({"semihosting",
                      "semihosting.read",
                      {{"raw", true}},
                      place_of(settings.semihosting.console())});
}

RunSession::RunSession(ChildSession session, const run::RunSettings& settings)
    : session_(std::move(session)) {
  divide(settings);
}

Result<RunSession> RunSession::start(const run::RunSettings& settings, const std::string& asked_by,
                                     const std::string& recorded) {
  auto child = ChildSession::start();
  if (!child) return Error{child.error()};
  RunSession session(std::move(child.value()), settings);
  if (auto error = session.construct(asked_by, recorded)) return *error;
  return session;
}

std::optional<Error> RunSession::construct(const std::string& asked_by,
                                           const std::string& recorded) {
  Json parameters = {{"settings", std::move(settings_)}};
  if (!recorded.empty()) parameters["session"] = recorded;
  const Answer constructed = client().call("simulation.construct", std::move(parameters));
  if (constructed.code == Code::no_simulation) {
    gone_ = ended_badly(constructed);
    return std::nullopt;
  }
  if (!constructed.ok()) return Error{constructed.sentence};
  simulation_ = constructed.result.at("simulation").get<uint64_t>();
  if (const std::string why = why_no_history(); !why.empty())
    return Error{fmt::format("{}: there is no history: {}", asked_by, why)};
  return std::nullopt;
}

/// "": there is one.
std::string RunSession::why_no_history() {
  const Answer history = ask("history.when");
  return history.ok() ? history.result.value("why", "") : "";
}

std::optional<Error> RunSession::renew(const Json& settings) {
  const Answer constructed = client().call("simulation.construct", {{"settings", settings}});
  if (!constructed.ok()) return Error{constructed.sentence};
  show();
  const uint64_t old =
      std::exchange(simulation_, constructed.result.at("simulation").get<uint64_t>());
  const std::string why = why_no_history();
  client().call("simulation.close", {{"simulation", why.empty() ? old : simulation_}});
  if (!why.empty()) {
    simulation_ = old;
    return Error{"there is no history: " + why};
  }
  lost_.clear();
  bytes_lost_ = 0;
  return std::nullopt;
}

Answer RunSession::ask(const std::string& method, Json parameters) {
  parameters["simulation"] = simulation_;
  return client().call(method, std::move(parameters));
}

std::vector<Answer> RunSession::ask_all(Questions questions) {
  return take_all(send_all(std::move(questions)));
}

RunSession::Numbers RunSession::send_all(Questions questions) {
  for (auto& question : questions) question.second["simulation"] = simulation_;
  return client().send_all(questions);
}

std::vector<Answer> RunSession::take_all(const Numbers& numbers) {
  std::vector<Answer> answers;
  constexpr std::chrono::milliseconds a_while{1000};
  for (const uint64_t number : numbers) {
    std::optional<Answer> answer;
    while (!answer) answer = client().wait(number, a_while);
    answers.push_back(std::move(*answer));
  }
  return answers;
}

void RunSession::hear(Heard heard) {
  heard_ = std::move(heard);
}

bool RunSession::is_read(const Stream& stream) const {
  return stream.place != Stream::Place::nowhere || (heard_ && stream.method == "uart.read");
}

void RunSession::show() {
  show(ask_all(stream_questions()));
}

RunSession::Questions RunSession::stream_questions() const {
  Questions questions;
  for (const Stream& stream : streams_)
    if (is_read(stream)) questions.emplace_back(stream.method, stream.parameters);
  return questions;
}

void RunSession::show(const std::vector<Answer>& answers) {
  auto next = answers.begin();
  for (const Stream& stream : streams_) {
    if (!is_read(stream)) continue;
    const Answer& answer = *next++;
    if (!answer.ok()) continue;
    if (stream.place != Stream::Place::nowhere)
      bytes_lost_ += answer.result.at("lost").get<uint64_t>();
    const std::string text = bytes_in(answer.result.at("text"), answer.frames);
    if (text.empty()) continue;
    if (heard_) heard_(stream.name, text);
    if (stream.place == Stream::Place::error)
      host::say(std::string_view(text));
    else if (stream.place == Stream::Place::output)
      host::print(std::string_view(text));
  }
}

bool RunSession::has_keys() const {
  pollfd keys{STDIN_FILENO, POLLIN, 0};
  return keyboard_ >= 0 && poll(&keys, 1, 0) > 0;
}

void RunSession::read_keys() {
  if (!has_keys()) return;
  char buffer[4096];
  const ssize_t count = read(STDIN_FILENO, buffer, sizeof buffer);
  if (count <= 0) {
    keyboard_ = -1;
    return;
  }
  const std::string_view typed(buffer, static_cast<std::size_t>(count));
  ask("uart.send", {{"uart", keyboard_}, {"bytes", array_of(typed)}});
}

/// A line at a time: between two of them what the program says is shown.
void RunSession::answer_console(std::chrono::milliseconds patience) {
  std::fflush(stdout);  // the question
  std::size_t end = typed_.find('\n');
  bool is_last = false;
  while (end == std::string::npos && !is_last) {
    pollfd keys{STDIN_FILENO, POLLIN, 0};
    if (poll(&keys, 1, static_cast<int>(patience.count())) <= 0) return;
    std::array<char, 4096> buffer;
    const ssize_t count = read(STDIN_FILENO, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) return;
    is_last = count <= 0;
    if (!is_last) typed_.append(buffer.data(), static_cast<std::size_t>(count));
    end = typed_.find('\n');
    if (!is_last && isatty(STDIN_FILENO) != 0) break;  // a terminal ends lines otherwise, too
  }
  const std::size_t size = end == std::string::npos ? typed_.size() : end + 1;
  ask("semihosting.send", {{"bytes", array_of(typed_.substr(0, size))}, {"end", is_last}});
  typed_.erase(0, size);
}

void RunSession::record() {
  if (session_file_.empty()) return;
  Json parameters = {{"file", session_file_}};
  if (keep_last_s_ > 0) parameters["last_s"] = keep_last_s_;
  const Answer answer = ask("simulation.record", std::move(parameters));
  if (!answer.ok()) lost_.push_back(answer.sentence);
}

Json RunSession::finish(const std::function<void()>& before) {
  if (is_gone()) return gone_;
  record();
  if (before) before();
  const Answer answer = ask("simulation.finish");
  show();
  Json finished = answer.ok() ? answer.result : ended_badly(answer);
  if (bytes_lost_ > 0)
    lost_.push_back(
        fmt::format("{} bytes that the program said were too many to be shown", bytes_lost_));
  Json& lost = finished["lost"];
  for (const std::string& sentence : lost_)
    if (std::find(lost.begin(), lost.end(), Json(sentence)) == lost.end()) lost.push_back(sentence);
  if (!lost_.empty() && finished["code"] == Json(run::exit_code::pass))
    finished["code"] = run::exit_code::lost;
  return finished;
}

}  // namespace capsoc::service
