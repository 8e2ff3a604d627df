#include "view/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace capsoc::view {
namespace {

constexpr std::chrono::milliseconds between_registers{250};  ///< while it runs
constexpr std::size_t most_text = 32768;  ///< of a stream, for a page that is opened later

/// In their order, after those about streams and before those about registers.
enum Question : std::size_t {
  of_state,
  of_when,
  of_signals,
  of_status,
  of_flags,
  of_activity,
  of_sensor,
  of_samples,
  question_count
};

std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// An object with one more member, whose text is there.
Text with_samples(const Json& object, const std::string& samples) {
  std::string text = dumped(object);
  text.pop_back();
  return std::make_shared<const std::string>(text + ",\"samples\":" + samples + "}");
}

Json result_of(const service::Answer& answer) {
  return answer.ok() ? answer.result : Json();
}

}  // namespace

Scene::Scene(service::RunSession& session) : session_(session) {
  session_.hear([this](const std::string& stream, const std::string& bytes) {
    new_text_[stream] += bytes;
    std::string& all = all_text_[stream] += bytes;
    if (all.size() > most_text) all.erase(0, all.size() - most_text);
  });
  list_registers();
}

void Scene::list_registers() {
  peripherals_.clear();
  const service::Answer list = session_.ask("register.list");
  if (!list.ok()) return;
  for (const Json& peripheral : list.result.at("peripherals"))
    for (const Json& each : peripheral.at("registers"))
      peripherals_[peripheral.at("name")].push_back(each.at("name"));
}

void Scene::begin_anew() {
  curves_ = Curves();
  next_sample_ = 0;
  new_text_.clear();
  all_text_.clear();
  said_.clear();
  list_registers();
  if (peripherals_.count(peripheral_) == 0) peripheral_ = "COPROCESSOR";
  moved();
  begins_ = true;
}

void Scene::moved() {
  is_moved_ = true;
  registers_read_ = {};
}

bool Scene::show_registers(const std::string& peripheral) {
  if (peripherals_.count(peripheral) == 0) return false;
  peripheral_ = peripheral;
  registers_read_ = {};
  return true;
}

double Scene::frequency_hz() const {
  if (!sensor_.is_object()) return 0;
  const Json& known = sensor_.at("parameters").at("frequency_hz");
  return known.is_number() ? known.get<double>() : 0;
}

/// After going back only the newest sample is there.
Scene::Questions::value_type Scene::ask_samples() const {
  Json parameters = {{"columns", Curves::columns()}};
  if (is_moved_) {
    parameters["last"] = 1;
  } else {
    parameters["first"] = next_sample_;
    parameters["most"] = Curves::most_new;
  }
  return {"samples.read", std::move(parameters)};
}

Scene::Questions::value_type Scene::ask_activity() const {
  return {"processor.activity", {{"window_s", time_line_.window_s()}}};
}

std::string Scene::show_window(double seconds) {
  const double before = time_line_.window_s();
  time_line_.set_window(seconds);
  const service::Answer answer = session_.ask_all({ask_activity()}).front();
  if (!answer.ok()) time_line_.set_window(before);
  time_line_.take(answer);
  return answer.sentence;
}

Scene::Questions Scene::questions(const Status& status) {
  Questions all = session_.stream_questions();
  stream_count_ = all.size();
  // The order of Question.
  all.emplace_back("simulation.state", Json::object());
  all.emplace_back("history.when", Json::object());
  all.emplace_back("coprocessor.read", Json::object());
  all.emplace_back("register.read", Json{{"name", "COPROCESSOR.STATUS"}});
  all.emplace_back("register.read", Json{{"name", "COPROCESSOR.FLAGS"}});
  all.push_back(ask_activity());
  all.emplace_back("sensor.read", Json::object());
  all.push_back(ask_samples());
  asks_registers_ = status.mode != "running" || Clock::now() - registers_read_ > between_registers;
  if (!asks_registers_) return all;
  for (const std::string& name : peripherals_[peripheral_])
    all.emplace_back("register.read", Json{{"name", peripheral_ + "." + name}});
  return all;
}

void Scene::take(const Status& status, const Answers& answers) {
  session_.show(answers);
  const auto of = [&](Question which) -> const service::Answer& {
    return answers[stream_count_ + which];
  };
  if (!of(of_state).ok()) return;
  state_ = of(of_state).result.at("state");
  place_ = status.mode == "running" ? Json() : of(of_state).result.value("place", Json());
  if (of(of_when).ok())
    history_ = {{"beginning_s", of(of_when).result["beginning"].value("time_s", 0.0)},
                {"end_s", of(of_when).result["end"].value("time_s", 0.0)},
                {"inputs", of(of_when).result.value("inputs", 0)}};
  coprocessor_ = of(of_signals).ok() ? of(of_signals).result.at("signals") : Json();
  status_register_ = result_of(of(of_status));
  flags_register_ = result_of(of(of_flags));
  time_line_.take(of(of_activity));
  sensor_ = result_of(of(of_sensor));
  take_samples(of(of_samples));
  if (asks_registers_) take_registers(answers, stream_count_ + question_count);
  is_moved_ = false;
}

/// Where the next one is no longer kept, the curves continue a frame later.
void Scene::take_samples(const service::Answer& answer) {
  next_sample_ = state_.value("samples", uint64_t{0});
  if (answer.ok()) return curves_.add(answer);
  next_sample_ -= std::min(next_sample_, Curves::most_new);
}

void Scene::take_registers(const Answers& answers, std::size_t first) {
  registers_read_ = Clock::now();
  registers_ = Json::array();
  for (const std::string& name : peripherals_[peripheral_]) {
    const service::Answer& answer = answers[first++];
    if (answer.ok())
      registers_.push_back({{"name", name},
                            {"value", answer.result.at("value")},
                            {"fields", answer.result.value("fields", Json::object())}});
  }
}

Json Scene::update(const Status& status) {
  Json object = {
      {"mode", status.mode},        {"speed", status.speed},    {"reason", status.reason},
      {"command", status.command},  {"host_s", status.host_s},  {"state", state_},
      {"history", history_},        {"sensor", sensor_},        {"coprocessor", coprocessor_},
      {"status", status_register_}, {"flags", flags_register_}, {"place", place_},
      {"peripheral", peripheral_},  {"registers", registers_},  {"said", said_},
      {"text", new_text_},          {"story", status.story},    {"activity", time_line_.shown()},
      {"run", status.run}};
  return object;
}

void Scene::send(Hub& hub, const Status& status, const Json* finished) {
  Json object = update(status);
  if (finished != nullptr) object["finished"] = *finished;
  Text full, fresh = with_samples(object, curves_.newest());
  if (finished != nullptr || begins_ || hub.wants_full()) {
    object["text"] = all_text_;
    object["choices"] = status.choices;
    Json& names = object["peripherals"] = Json::array();
    for (const auto& each : peripherals_) names.push_back(each.first);
    full = with_samples(object, curves_.all());
  }
  hub.publish(std::move(fresh), std::move(full), std::exchange(begins_, false));
  said_.clear();
  new_text_.clear();
}

void Scene::publish(Hub& hub, const Status& status) {
  Answers answers = session_.ask_all(questions(status));
  service::Answer& samples = answers[stream_count_ + of_samples];
  // The next one is perhaps no longer kept.
  if (!samples.ok())
    samples =
        session_.ask("samples.read", {{"last", Curves::most_new}, {"columns", Curves::columns()}});
  publish(hub, status, answers);
}

void Scene::publish(Hub& hub, const Status& status, const Answers& answers) {
  take(status, answers);
  send(hub, status, nullptr);
}

void Scene::publish_end(Hub& hub, const Status& status, const Json& finished) {
  const Json told = {{"code", finished.value("code", Json())},
                     {"reason", finished.value("reason", Json())},
                     {"table", finished.value("table", Json())},
                     {"reports", finished.value("reports", Json::array())},
                     {"lost", finished.value("lost", Json::array())}};
  send(hub, status, &told);
}

}  // namespace capsoc::view
