#include "service/history.h"

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <utility>

namespace capsoc::service {
namespace {

constexpr double ps_per_s = 1e12;
/// Of an entry in memory in addition to its texts.
constexpr std::size_t overhead = 200;

/// How many two histories have in common.
std::size_t common_inputs(const History::Inputs& one, const History::Inputs& other) {
  const auto [first, second] = std::mismatch(one.begin(), one.end(), other.begin(), other.end());
  return static_cast<std::size_t>(first - one.begin());
}

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
  snapshots_.push_back({at, 0, 0, std::move(bytes), next_serial_++});
  end_ = reached_ = at;
}

void History::expect(const std::vector<Input>& inputs, const Position& end) {
  for (const Input& input : inputs) {
    inputs_.push_back(std::make_shared<const Input>(input));
    input_bytes_ += size_of(input);
    budget_ += size_of(input);
  }
  if (end_ < end) end_ = end;
}

void History::add_snapshot(const Position& at, uint64_t effort_ns, std::string bytes) {
  const auto place =
      std::lower_bound(snapshots_.begin(), snapshots_.end(), at,
                       [](const Snapshot& one, const Position& other) { return one.at < other; });
  reach(at);
  if (place == snapshots_.begin() || (place != snapshots_.end() && place->at == at)) return;
  snapshot_bytes_ += bytes.size() + overhead;
  snapshots_.insert(place, {at, applied_, effort_ns, std::move(bytes), next_serial_++});
  fit();
}

std::optional<History::Ended> History::add(Input input) {
  const Position at = input.at;
  std::optional<Ended> ended;
  if (at < end_) {
    ended = Ended{end_, number_};
    leave();
    number_ = ++greatest_number_;
  }
  while (at < snapshots_.back().at || (ended && snapshots_.back().inputs > applied_))
    remove(snapshots_.size() - 1);
  Inputs others;
  while (dropped_ + inputs_.size() > applied_) {
    others.push_back(std::move(inputs_.back()));
    inputs_.pop_back();
  }
  drop(others);
  input_bytes_ += size_of(input);
  inputs_.push_back(std::make_shared<const Input>(std::move(input)));
  ++applied_;
  end_ = reached_ = at;
  remeasure();
  fit();
  return ended;
}

void History::leave() {
  if (left_.size() == most_left) drop_least();
  Left left{number_, end_, end_, inputs_};
  const auto less = [](const Left& one, const Left& other) { return one.number < other.number; };
  left_.insert(std::upper_bound(left_.begin(), left_.end(), left, less), std::move(left));
}

bool History::select(uint64_t number) {
  const auto found = std::find_if(left_.begin(), left_.end(),
                                  [number](const Left& each) { return each.number == number; });
  if (found == left_.end()) return false;
  Left selected = std::move(*found);
  left_.erase(found);
  leave();
  number_ = selected.number;
  while (snapshots_.size() > 1 && selected.from < snapshots_.back().at)
    remove(snapshots_.size() - 1);
  const uint64_t common = common_inputs(inputs_, selected.inputs);
  while (snapshots_.size() > 1 && snapshots_.back().inputs > dropped_ + common)
    remove(snapshots_.size() - 1);
  inputs_ = std::move(selected.inputs);
  end_ = selected.end;
  reached_ = selected.from;
  applied_ = dropped_ + common;
  remeasure();
  return true;
}

/// Where each history that was left parts from the present one.
void History::remeasure() {
  for (Left& left : left_) {
    const std::size_t common = common_inputs(inputs_, left.inputs);
    left.from = std::min(end_, left.end);
    for (const Inputs* inputs : std::initializer_list<const Inputs*>{&inputs_, &left.inputs})
      if (common < inputs->size()) left.from = std::min(left.from, (*inputs)[common]->at);
  }
}

void History::drop_least() {
  const auto way = [](const Left& left) { return left.end.time_ps - left.from.time_ps; };
  const auto least =
      std::min_element(left_.begin(), left_.end(),
                       [&](const Left& one, const Left& other) { return way(one) < way(other); });
  const Inputs inputs = std::move(least->inputs);
  left_.erase(least);
  drop(inputs);
}

/// Inputs of a history; others may have them, too.
void History::drop(const Inputs& inputs) {
  for (const auto& input : inputs)
    if (input.use_count() == 1) input_bytes_ -= size_of(*input);
}

void History::reach(const Position& at) {
  if (reached_ < at) reached_ = at;
  if (end_ < at) end_ = at;
}

const Input* History::next() const {
  const uint64_t index = applied_ - dropped_;
  return index < inputs_.size() ? inputs_[index].get() : nullptr;
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
    if (!left_.empty() && (input_bytes_ > budget_ / 2 || snapshots_.size() <= 2))
      drop_least();
    else if (snapshots_.size() > 2)
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
  const Snapshot& front = snapshots_.front();
  const auto count = static_cast<std::ptrdiff_t>(front.inputs - dropped_);
  std::vector<Left> reachable;
  for (Left& left : left_) {
    const bool is_reachable = !(left.from < front.at) && static_cast<std::ptrdiff_t>(common_inputs(
                                                             inputs_, left.inputs)) >= count;
    if (is_reachable) left.inputs.erase(left.inputs.begin(), left.inputs.begin() + count);
    if (is_reachable)
      reachable.push_back(std::move(left));
    else
      drop(left.inputs);
  }
  left_ = std::move(reachable);
  Inputs before(inputs_.begin(), inputs_.begin() + count);
  inputs_.erase(inputs_.begin(), inputs_.begin() + count);
  drop(before);
  dropped_ = front.inputs;
}

Json History::pack(Frames& frames, const std::set<uint64_t>& known) const {
  Json about = {
      {"budget", budget_},    {"dropped", dropped_},          {"applied", applied_},
      {"end", to_json(end_)}, {"reached", to_json(reached_)}, {"log", frames.size()},
      {"number", number_},    {"greatest", greatest_number_}, {"next_serial", next_serial_}};
  const auto add_log = [&frames](const Inputs& inputs, std::size_t from) {
    std::string log;
    for (std::size_t i = from; i < inputs.size(); ++i) log += to_bytes(*inputs[i]);
    frames.push_back(std::move(log));
  };
  add_log(inputs_, 0);
  Json& left = about["left"] = Json::array();
  std::vector<const Inputs*> packed = {&inputs_};
  for (const Left& each : left_) {
    std::size_t base = 0;  // the one with the most in common
    for (std::size_t i = 1; i < packed.size(); ++i)
      if (common_inputs(*packed[i], each.inputs) > common_inputs(*packed[base], each.inputs))
        base = i;
    const std::size_t common = common_inputs(*packed[base], each.inputs);
    left.push_back({{"number", each.number},
                    {"end", to_json(each.end)},
                    {"base", base},
                    {"common", common},
                    {"log", frames.size()}});
    add_log(each.inputs, common);
    packed.push_back(&each.inputs);
  }
  Json& list = about["snapshots"] = Json::array();
  for (const Snapshot& each : snapshots_) {
    list.push_back({{"at", to_json(each.at)},
                    {"inputs", each.inputs},
                    {"effort_ns", each.effort_ns},
                    {"serial", each.serial}});
    if (known.count(each.serial) > 0) continue;
    list.back()["frame"] = frames.size();
    frames.push_back(each.bytes);
  }
  return about;
}

Result<History> History::unpack(const Json& about, Frames frames, History known) {
  History history(about.at("budget").get<std::size_t>());
  history.dropped_ = about.at("dropped").get<uint64_t>();
  history.applied_ = about.at("applied").get<uint64_t>();
  history.end_ = position_in(about.at("end")).value_or(Position());
  history.reached_ = position_in(about.at("reached")).value_or(Position());
  history.number_ = about.at("number").get<uint64_t>();
  history.next_serial_ = about.at("next_serial").get<uint64_t>();
  history.greatest_number_ = about.at("greatest").get<uint64_t>();
  const auto add_log = [&](const Json& log, Inputs& to) -> std::optional<Error> {
    auto inputs = inputs_in(frames.at(log.get<std::size_t>()));
    if (!inputs) return Error{inputs.error()};
    for (Input& input : inputs.value()) {
      history.input_bytes_ += size_of(input);
      to.push_back(std::make_shared<const Input>(std::move(input)));
    }
    return std::nullopt;
  };
  if (auto error = add_log(about.at("log"), history.inputs_)) return *error;
  for (const Json& each : about.at("left")) {
    const auto base = each.at("base").get<std::size_t>();
    const Inputs& shared = base == 0 ? history.inputs_ : history.left_.at(base - 1).inputs;
    const auto common = each.at("common").get<std::ptrdiff_t>();
    if (common > static_cast<std::ptrdiff_t>(shared.size()))
      return Error{"a history without its beginning"};
    Left left;
    left.number = each.at("number").get<uint64_t>();
    left.end = position_in(each.at("end")).value_or(Position());
    left.inputs.assign(shared.begin(), shared.begin() + common);
    if (auto error = add_log(each.at("log"), left.inputs)) return *error;
    history.left_.push_back(std::move(left));
  }
  history.remeasure();
  const auto bytes_of = [&](const Json& each) -> std::optional<std::string> {
    if (const auto frame = each.find("frame"); frame != each.end())
      return std::move(frames.at(frame->get<std::size_t>()));
    for (Snapshot& snapshot : known.snapshots_)
      if (snapshot.serial == each.at("serial").get<uint64_t>()) return std::move(snapshot.bytes);
    return std::nullopt;
  };
  for (const Json& each : about.at("snapshots")) {
    auto bytes = bytes_of(each);
    if (!bytes) return Error{"a history with a snapshot that is not known here"};
    Snapshot snapshot{position_in(each.at("at")).value_or(Position()),
                      each.at("inputs").get<uint64_t>(), each.at("effort_ns").get<uint64_t>(),
                      std::move(*bytes), each.at("serial").get<uint64_t>()};
    history.snapshot_bytes_ += snapshot.bytes.size() + overhead;
    history.snapshots_.push_back(std::move(snapshot));
  }
  if (history.snapshots_.empty()) return Error{"a history without a beginning"};
  return history;
}

}  // namespace capsoc::service
