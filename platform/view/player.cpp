#include "view/player.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/printable.h"
#include "host/end_signals.h"
#include "view/controls.h"

namespace capsoc::view {
namespace {

using service::Answer;
using service::Code;
using std::chrono::milliseconds;

constexpr milliseconds frame{33};         ///< between two frames, while a page is open
constexpr milliseconds frame_alone{500};  ///< while none is
constexpr milliseconds nap{50};           ///< of a run that stands
constexpr milliseconds look{2};           ///< how soon a command is heard while it runs
constexpr int most_share = 16;            ///< a frame costs at most a part of the time between two

milliseconds since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration_cast<milliseconds>(std::chrono::steady_clock::now() - begin);
}

}  // namespace

Player::Player(service::RunSession session, Hub& hub, double speed, const Choices* choices,
               const Story* story)
    : session_(std::move(session)), hub_(hub), scene_(session_), choices_(choices), story_(story) {
  status_.mode = "waiting";
  status_.speed = speed;
  if (choices == nullptr) return;
  status_.run = choices->first(story).shown;
  status_.choices = choices->shown();
}

Json Player::perform() {
  publish();
  while (host::noted_signal() == 0 && !is_ended_ && !is_gone_) {
    if (is_wanted()) settle();
    if (!under_way_) {
      for (const Command& command : hub_.take_commands()) obey(command);
      session_.read_keys();
    }
    if (status_.mode == "waiting" && hub_.viewers() > 0) {
      publish();  // the beginning
      stop("running", "");
      begin_pace();
      tell_story();  // it may begin with a step
    }
    if (is_ended_) break;
    if (status_.mode == "running")
      play();
    else
      stand();
  }
  settle();
  if (!is_gone_) publish();
  Json finished = session_.finish();
  status_.mode = "ended";
  scene_.publish_end(hub_, status_, finished);
  return finished;
}

bool Player::is_interrupted() const {
  return hub_.has_commands() || host::noted_signal() != 0;
}

/// What an advance under way would hold up.
bool Player::is_wanted() const {
  return is_interrupted() || session_.has_keys();
}

/// A frame whose cost is a small share of it.
milliseconds Player::slice() const {
  if (hub_.viewers() == 0) return frame_alone;
  return std::max(frame, looked_for_ * most_share);
}

void Player::publish() {
  const auto begin = Clock::now();
  status_.story = story_.shown();
  scene_.publish(hub_, status_);
  looked_for_ = since(begin) + milliseconds(1);
  has_news_ = false;
}

void Player::stop(const char* mode, const std::string& reason) {
  status_.mode = mode;
  status_.reason = reason;
  has_news_ = true;
}

/// At a step of the story the run stops, so that its text can be read.
void Player::tell_story() {
  const Story::Step* const step = story_.reach(scene_.time_s(), status_.mode == "running");
  if (step == nullptr) return;
  // Of a past that the run has gone back to, the command is in the history.
  if (story_.is_due(*step)) {
    const auto refusal = carry_out(session_, step->command);
    if (refusal && !refusal->empty()) scene_.say(*refusal);
    scene_.moved();
  }
  stop("paused", "");
}

void Player::stand() {
  if (has_news_ || hub_.wants_full()) publish();
  // What was typed may wake it.
  if (status_.mode == "asleep" && session_.reads_keys()) status_.mode = "running";
  if (!hub_.has_commands()) hub_.wait(nap);
}

void Player::begin_pace() {
  pace_begin_ = Clock::now();
  pace_begin_s_ = scene_.time_s();
}

void Player::play() {
  const auto begin = Clock::now();
  if (status_.speed > 0)
    play_paced();
  else
    play_at_once();
  status_.host_s += std::chrono::duration<double>(Clock::now() - begin).count();
  tell_story();
}

void Player::play_at_once() {
  if (!under_way_) begin_advance();
  for (;;) {
    if (const auto answer = session_.client().wait(*under_way_, look)) {
      under_way_.reset();
      if (conclude(*answer) || has_news_) publish();
      return;
    }
    if (is_wanted()) {
      settle();
      return publish();
    }
    if (since(advanced_) >= slice()) return pass();
  }
}

void Player::begin_advance() {
  const auto next_s = story_.next_s(scene_.time_s());
  Json parameters = next_s ? Json{{"until_s", *next_s}} : Json{{"kind", "run"}, {"stopped", false}};
  parameters["simulation"] = session_.simulation();
  advanced_ = Clock::now();
  under_way_ = session_.client().send(next_s ? "simulation.advance" : "debugger.resume",
                                      std::move(parameters));
}

/// A frame of a run that continues: the next advance is under way while the frame is made.
void Player::pass() {
  const auto begin = Clock::now();
  Scene::Questions questions = scene_.questions(status_);
  questions.emplace(questions.begin(), "simulation.interrupt", Json::object());
  const auto numbers = session_.send_all(std::move(questions));
  const Answer stopped = session_.take_all({*std::exchange(under_way_, std::nullopt)}).front();
  conclude(stopped);
  // One that was not cut short has stopped for a reason.
  const bool goes_on = stopped.ok() && stopped.result.at("reason") == Json("interrupted");
  if (goes_on && !is_interrupted()) begin_advance();
  Scene::Answers answers = session_.take_all(numbers);
  looked_for_ = since(begin) + milliseconds(1);
  answers.erase(answers.begin());
  status_.story = story_.shown();
  has_news_ = has_news_ && !goes_on;
  scene_.publish(hub_, status_, answers);
}

/// The simulation stands afterwards, and can be asked.
void Player::settle() {
  if (!under_way_) return;
  session_.ask("simulation.interrupt");
  conclude(session_.take_all({*std::exchange(under_way_, std::nullopt)}).front());
}

void Player::play_paced() {
  const auto begin = Clock::now();
  const double host_s = std::chrono::duration<double>(begin - pace_begin_).count();
  double target = pace_begin_s_ + status_.speed * host_s;
  if (const auto next_s = story_.next_s(scene_.time_s())) target = std::min(target, *next_s);
  is_cut_ = false;
  if (target > scene_.time_s()) advance("simulation.advance", {{"until_s", target}}, slice());
  publish();
  // A host that is too slow for the pace does not catch up later.
  if (is_cut_) begin_pace();
  // The simulation has time to spare, so a frame may cost more of it than at full speed.
  const milliseconds between = hub_.viewers() == 0 ? frame_alone : frame;
  const milliseconds left = between - std::min(between, since(begin));
  if (status_.mode == "running" && !hub_.has_commands()) hub_.wait(left);
}

bool Player::advance(const std::string& method, Json parameters, milliseconds longest) {
  const auto begin = Clock::now();
  parameters["simulation"] = session_.simulation();
  const uint64_t number = session_.client().send(method, std::move(parameters));
  bool asked = false;
  for (;;) {
    auto answer = session_.client().wait(number, look);
    if (answer) return conclude(*answer);
    if (asked || !(is_interrupted() || since(begin) >= longest)) continue;
    is_cut_ = asked = true;
    session_.ask("simulation.interrupt");
  }
}

/// False: it stands, and has to be asked for more.
bool Player::conclude(const Answer& answer) {
  if (!answer.ok()) {
    is_gone_ = answer.code == Code::no_simulation;
    stop(answer.code == Code::over ? "over" : "paused", answer.sentence);
    return false;
  }
  const auto reason = answer.result.at("reason").get<std::string>();
  const bool goes_on = reason == "interrupted" || reason == "end";
  if (goes_on || reason == "time" || reason == "samples") return true;
  if (reason == "over")
    stop("over", "the run is over");
  else if (reason == "asleep")
    stop("asleep", "the program sleeps until something comes from outside");
  else
    stop("paused", reason);
  return false;
}

std::string Player::step(Json parameters, const std::string& what) {
  if (status_.mode == "over") return "the run is over; go back first";
  stop("paused", what);
  const auto longest = std::chrono::seconds(3600);
  advance("simulation.advance", std::move(parameters), longest);
  return "";
}

std::string Player::obey_goto(const Json& body) {
  const auto time = body.find("time_s");
  if (time == body.end() || !time->is_number()) return "goto: give \"time_s\", a number";
  const Answer answer = session_.ask("simulation.goto", {{"time_s", *time}});
  if (!answer.ok()) return answer.sentence;
  scene_.moved();
  story_.reach(answer.result.at("state").at("time_s").get<double>(), false);
  const bool is_over = answer.result.at("state").at("over").get<bool>();
  stop(is_over ? "over" : "paused", is_over ? "the run is over" : "");
  return "";
}

std::string Player::set_speed(const Json& body) {
  const auto factor = body.find("factor");
  if (factor == body.end() || !factor->is_number() || !(factor->get<double>() >= 0) ||
      factor->get<double>() > 1e6)
    return "speed: give \"factor\", simulated seconds a second, up to 1e6; 0: as fast as it can";
  status_.speed = factor->get<double>();
  begin_pace();
  return "";
}

/// The record of a run that stands is made longer by going where it stands: what is on the way is
/// recorded.
std::string Player::set_window(const Json& body) {
  const auto window = body.find("window_s");
  if (window == body.end() || !window->is_number() || !(window->get<double>() > 0))
    return "activity: give \"window_s\": 0.001, 0.01, 0.1, 1, 10 or 100";
  if (std::string refusal = scene_.show_window(*window); !refusal.empty()) return refusal;
  if (status_.mode == "running" || status_.mode == "waiting" || !scene_.lacks_past()) return "";
  const Answer answer =
      session_.ask("simulation.goto", {{"time_ps", scene_.state().at("time_ps")}});
  if (answer.ok()) scene_.moved();
  return answer.sentence;
}

/// Another run takes the place of this one, which continues if that is refused.
std::string Player::begin_new(const Json& body) {
  if (choices_ == nullptr)
    return "new: the run of a recording is shown; start capsoc view for another one";
  const auto chosen = choices_->choose(body);
  if (!chosen) return chosen.error();
  if (auto error = session_.renew(chosen.value().settings)) return "new: " + error->text;
  story_ = StoryCourse(chosen.value().story);
  if (chosen.value().story != nullptr) status_.speed = chosen.value().story->speed;
  status_.run = chosen.value().shown;
  status_.host_s = 0;
  scene_.begin_anew();
  stop("waiting", "");
  return "";
}

/// Null text: done. A sentence: refused.
std::string Player::obey_transport(const std::string& what, const Json& body) {
  if (what == "goto") return obey_goto(body);
  if (what == "speed") return set_speed(body);
  if (what == "activity") return set_window(body);
  if (what == "sample") return step({{"samples", 1}, {"within_s", 60}}, "one sample");
  if (what == "pause") {
    if (status_.mode != "over") stop("paused", "");
    return "";
  }
  if (what == "run") {
    if (status_.mode == "over") return "the run is over; go back first";
    stop("running", "");
    begin_pace();
    return "";
  }
  const double turns = std::fabs(scene_.frequency_hz());
  if (!(turns > 0)) return "turn: the sensor's speed is not one that is known";
  return step({{"seconds", 1 / turns}}, "one turn");
}

void Player::obey(const Command& command) {
  static const std::string transport[] = {"pause", "run",  "speed",   "sample",
                                          "turn",  "goto", "activity"};
  const auto what = command.body.at("do").get<std::string>();
  std::optional<std::string> refusal;
  if (what == "end") {
    is_ended_ = true;
    refusal = "";
  } else if (what == "new") {
    refusal = begin_new(command.body);
  } else if (what == "registers") {
    const Json name = command.body.value("peripheral", Json());
    refusal = name.is_string() && scene_.show_registers(name) ? "" : "there is no such peripheral";
  } else if (std::find(std::begin(transport), std::end(transport), what) != std::end(transport)) {
    refusal = obey_transport(what, command.body);
  } else if ((refusal = carry_out(session_, command.body))) {
    if (refusal->empty() && scene_.is_past()) story_.forget_after(scene_.time_s());
    scene_.moved();
    if (status_.mode == "asleep") stop("running", "");
  }
  if (!refusal) refusal = fmt::format("there is no command '{}'", printable(what, 80));
  if (!refusal->empty()) scene_.say(*refusal);
  status_.command = command.number;
  has_news_ = true;
}

}  // namespace capsoc::view
