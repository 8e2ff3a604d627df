#include "service/history.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace capsoc::service {
namespace {

constexpr double ps_per_s = 1e12;
/// Of an entry in memory in addition to its texts.
constexpr std::size_t overhead = 200;

}  // namespace

Json to_json(const Position& position) {
  return {{"time_s", static_cast<double>(position.time_ps) / ps_per_s},
          {"time_ps", position.time_ps},
          {"cycles", position.cycles},
          {"instructions", position.instructions},
          {"samples", position.samples}};
}

std::optional<Position> position_in(const Json& value) {
  if (!value.is_object()) return std::nullopt;
  Position position;
  for (const auto& [name, member] :
       {std::pair("time_ps", &position.time_ps), std::pair("cycles", &position.cycles),
        std::pair("instructions", &position.instructions),
        std::pair("samples", &position.samples)}) {
    const auto found = value.find(name);
    if (found == value.end() || !found->is_number_unsigned()) return std::nullopt;
    *member = found->get<uint64_t>();
  }
  return position;
}

Json to_json(const Target& target) {
  return {{"unit", static_cast<int>(target.unit)}, {"value", target.value}};
}

Target target_in(const Json& goal) {
  return {static_cast<Unit>(goal.at("unit").get<int>()), goal.at("value").get<uint64_t>()};
}

uint64_t coordinate(const Position& position, Unit unit) {
  switch (unit) {
    case Unit::time:
      return position.time_ps;
    case Unit::cycles:
      return position.cycles;
    case Unit::instructions:
      return position.instructions;
    case Unit::samples:
      return position.samples;
  }
  return 0;
}

std::string to_bytes(const Input& input) {
  return to_bytes(
      Message{{{"at", to_json(input.at)}, {"method", input.method}, {"params", input.parameters}},
              input.frames});
}

Result<std::vector<Input>> inputs_in(const std::string& bytes) {
  const auto damaged = [] { return Error{"the log of inputs is damaged"}; };
  MessageReader reader;
  reader.feed(bytes);
  std::vector<Input> inputs;
  while (auto incoming = reader.next()) {
    if (!incoming->message) return damaged();
    Json& body = incoming->message->body;
    const auto at = body.find("at"), method = body.find("method"), parameters = body.find("params");
    if (at == body.end() || method == body.end() || !method->is_string() ||
        parameters == body.end() || !parameters->is_object())
      return damaged();
    const auto position = position_in(*at);
    if (!position || (!inputs.empty() && *position < inputs.back().at)) return damaged();
    inputs.push_back({*position, method->get<std::string>(), std::move(*parameters),
                      std::move(incoming->message->frames)});
  }
  if (!reader.is_empty()) return damaged();
  return inputs;
}

void History::begin(const Position& at, std::string bytes) {
  if (budget_ == 0) return;
  snapshot_bytes_ = bytes.size() + overhead;
  snapshots_.push_back({at, 0, 0, std::move(bytes)});
  end_ = reached_ = at;
}

void History::expect(const std::vector<Input>& inputs, const Position& end) {
  inputs_.assign(inputs.begin(), inputs.end());
  if (end_ < end) end_ = end;
}

void History::add_snapshot(const Position& at, uint64_t effort_ns, std::string bytes) {
  const auto place =
      std::lower_bound(snapshots_.begin(), snapshots_.end(), at,
                       [](const Snapshot& one, const Position& other) { return one.at < other; });
  reach(at);
  if (place == snapshots_.begin() || (place != snapshots_.end() && place->at == at)) return;
  snapshot_bytes_ += bytes.size() + overhead;
  snapshots_.insert(place, {at, applied_, effort_ns, std::move(bytes)});
  fit();
}

std::optional<Position> History::add(Input input) {
  const Position at = input.at;
  std::optional<Position> ended;
  if (at < end_) ended = end_;
  while (at < snapshots_.back().at || (ended && snapshots_.back().inputs > applied_))
    remove(snapshots_.size() - 1);
  while (dropped_ + inputs_.size() > applied_) {
    input_bytes_ -= size_of(inputs_.back());
    inputs_.pop_back();
  }
  input_bytes_ += size_of(input);
  inputs_.push_back(std::move(input));
  ++applied_;
  end_ = reached_ = at;
  fit();
  return ended;
}

void History::reach(const Position& at) {
  if (reached_ < at) reached_ = at;
  if (end_ < at) end_ = at;
}

const Input* History::next() const {
  const uint64_t index = applied_ - dropped_;
  return index < inputs_.size() ? &inputs_[index] : nullptr;
}

std::size_t History::before(const Target& target) const {
  std::size_t found = 0;
  for (std::size_t i = 1; i < snapshots_.size(); ++i)
    if (coordinate(snapshots_[i].at, target.unit) < target.value) found = i;
  return found;
}

std::size_t History::before(const Position& position) const {
  std::size_t found = 0;
  for (std::size_t i = 1; i < snapshots_.size(); ++i)
    if (snapshots_[i].at <= position) found = i;
  return found;
}

std::size_t History::size_of(const Input& input) {
  std::size_t size = overhead + input.method.size() + input.parameters.dump().size();
  for (const std::string& frame : input.frames) size += frame.size();
  return size;
}

/// Thins with age: a snapshot is missed the less, the shorter the way is from the one before it to
/// the one after it, compared with how long ago it was.
std::size_t History::least_missed() const {
  const double now = static_cast<double>(snapshots_.back().effort_ns);
  std::size_t found = 1;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i + 1 < snapshots_.size(); ++i) {
    const double gap =
        static_cast<double>(snapshots_[i + 1].effort_ns - snapshots_[i - 1].effort_ns);
    const double age = now - static_cast<double>(snapshots_[i].effort_ns) + 1;
    if (gap / age >= least) continue;
    least = gap / age;
    found = i;
  }
  return found;
}

void History::fit() {
  while (bytes() > budget_ || snapshots_.size() > most_snapshots) {
    if (snapshots_.size() > 2)
      remove(least_missed());
    else if (snapshots_.size() == 2)
      move_beginning();
    else
      return;  // one state and what came since is the least there can be
  }
}

void History::remove(std::size_t snapshot) {
  snapshot_bytes_ -= snapshots_[snapshot].bytes.size() + overhead;
  snapshots_.erase(snapshots_.begin() + static_cast<std::ptrdiff_t>(snapshot));
}

void History::move_beginning() {
  remove(0);
  while (dropped_ < snapshots_.front().inputs) {
    input_bytes_ -= size_of(inputs_.front());
    inputs_.pop_front();
    ++dropped_;
  }
}

Json History::pack(Frames& frames) const {
  std::string log;
  for (const Input& input : inputs_) log += to_bytes(input);
  Json about = {{"budget", budget_},    {"dropped", dropped_},          {"applied", applied_},
                {"end", to_json(end_)}, {"reached", to_json(reached_)}, {"log", frames.size()}};
  frames.push_back(std::move(log));
  Json& list = about["snapshots"] = Json::array();
  for (const Snapshot& each : snapshots_) {
    list.push_back({{"at", to_json(each.at)},
                    {"inputs", each.inputs},
                    {"effort_ns", each.effort_ns},
                    {"frame", frames.size()}});
    frames.push_back(each.bytes);
  }
  return about;
}

Result<History> History::unpack(const Json& about, Frames frames) {
  History history(about.at("budget").get<std::size_t>());
  history.dropped_ = about.at("dropped").get<uint64_t>();
  history.applied_ = about.at("applied").get<uint64_t>();
  history.end_ = position_in(about.at("end")).value_or(Position());
  history.reached_ = position_in(about.at("reached")).value_or(Position());
  auto inputs = inputs_in(frames.at(about.at("log").get<std::size_t>()));
  if (!inputs) return Error{inputs.error()};
  for (Input& input : inputs.value()) {
    history.input_bytes_ += size_of(input);
    history.inputs_.push_back(std::move(input));
  }
  for (const Json& each : about.at("snapshots")) {
    Snapshot snapshot{position_in(each.at("at")).value_or(Position()),
                      each.at("inputs").get<uint64_t>(), each.at("effort_ns").get<uint64_t>(),
                      std::move(frames.at(each.at("frame").get<std::size_t>()))};
    history.snapshot_bytes_ += snapshot.bytes.size() + overhead;
    history.snapshots_.push_back(std::move(snapshot));
  }
  if (history.snapshots_.empty()) return Error{"a history without a beginning"};
  return history;
}

}  // namespace capsoc::service
