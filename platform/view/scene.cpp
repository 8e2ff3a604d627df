#include "view/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace capsoc::view {
namespace {

constexpr std::chrono::milliseconds between_registers{250};  ///< while it runs
constexpr std::size_t most_text = 32768;  ///< of a stream, for a page that is opened later

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
  const service::Answer list = session_.ask("register.list");
  if (!list.ok()) return;
  for (const Json& peripheral : list.result.at("peripherals"))
    for (const Json& each : peripheral.at("registers"))
      peripherals_[peripheral.at("name")].push_back(each.at("name"));
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

void Scene::read_samples() {
  const uint64_t count = state_.value("samples", uint64_t{0});
  // After going back only the newest sample is there.
  if (is_moved_) next_sample_ = count == 0 ? 0 : count - 1;
  const uint64_t fresh = count - std::min(count, next_sample_);
  const uint64_t every = std::max<uint64_t>(1, (fresh + Curves::most_new - 1) / Curves::most_new);
  Json parameters = {{"first", next_sample_}, {"every", every}, {"columns", Curves::columns()}};
  service::Answer answer = session_.ask("samples.read", parameters);
  if (!answer.ok()) {
    parameters.erase("first");
    parameters["last"] = Curves::most_new;
    parameters["every"] = 1;
    answer = session_.ask("samples.read", parameters);
  }
  if (!answer.ok()) return;
  curves_.add(answer);
  next_sample_ = count;
}

void Scene::read_registers() {
  registers_read_ = Clock::now();
  std::vector<std::pair<std::string, Json>> questions;
  const std::vector<std::string>& names = peripherals_[peripheral_];
  questions.reserve(names.size());
  for (const std::string& name : names)
    questions.emplace_back("register.read", Json{{"name", peripheral_ + "." + name}});
  const std::vector<service::Answer> answers = session_.ask_all(questions);
  registers_ = Json::array();
  for (std::size_t i = 0; i < names.size(); ++i)
    if (answers[i].ok())
      registers_.push_back({{"name", names[i]},
                            {"value", answers[i].result.at("value")},
                            {"fields", answers[i].result.value("fields", Json::object())}});
}

service::RunSession::Questions::value_type Scene::activity() const {
  return {"processor.activity", {{"window_s", time_line_.window_s()}}};
}

std::string Scene::show_window(double seconds) {
  const double before = time_line_.window_s();
  time_line_.set_window(seconds);
  const service::Answer answer = session_.ask_all({activity()}).front();
  if (!answer.ok()) time_line_.set_window(before);
  time_line_.take(answer);
  return answer.sentence;
}

void Scene::look(const Status& status) {
  session_.show();
  const auto answers = session_.ask_all({{"simulation.state", Json::object()},
                                         {"history.when", Json::object()},
                                         {"coprocessor.read", Json::object()},
                                         {"register.read", {{"name", "COPROCESSOR.STATUS"}}},
                                         {"register.read", {{"name", "COPROCESSOR.FLAGS"}}},
                                         activity()});
  if (!answers[0].ok()) return;
  state_ = answers[0].result.at("state");
  place_ = status.mode == "running" ? Json() : answers[0].result.value("place", Json());
  if (answers[1].ok())
    history_ = {{"beginning_s", answers[1].result["beginning"].value("time_s", 0.0)},
                {"end_s", answers[1].result["end"].value("time_s", 0.0)},
                {"inputs", answers[1].result.value("inputs", 0)}};
  coprocessor_ = answers[2].ok() ? answers[2].result.at("signals") : Json();
  status_register_ = result_of(answers[3]);
  flags_register_ = result_of(answers[4]);
  time_line_.take(answers[5]);
  if (is_moved_) sensor_ = result_of(session_.ask("sensor.read"));
  read_samples();
  if (status.mode != "running" || Clock::now() - registers_read_ > between_registers)
    read_registers();
  is_moved_ = false;
}

Json Scene::update(const Status& status) {
  Json object = {
      {"mode", status.mode},        {"speed", status.speed},    {"reason", status.reason},
      {"command", status.command},  {"host_s", status.host_s},  {"state", state_},
      {"history", history_},        {"sensor", sensor_},        {"coprocessor", coprocessor_},
      {"status", status_register_}, {"flags", flags_register_}, {"place", place_},
      {"peripheral", peripheral_},  {"registers", registers_},  {"said", said_},
      {"text", new_text_},          {"story", status.story},    {"activity", time_line_.shown()}};
  return object;
}

void Scene::send(Hub& hub, const Status& status, const Json* finished) {
  Json object = update(status);
  if (finished != nullptr) object["finished"] = *finished;
  Text full, fresh = with_samples(object, curves_.newest());
  if (finished != nullptr || hub.wants_full()) {
    object["text"] = all_text_;
    Json& names = object["peripherals"] = Json::array();
    for (const auto& each : peripherals_) names.push_back(each.first);
    full = with_samples(object, curves_.all());
  }
  hub.publish(std::move(fresh), std::move(full));
  said_.clear();
  new_text_.clear();
}

void Scene::publish(Hub& hub, const Status& status) {
  look(status);
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
