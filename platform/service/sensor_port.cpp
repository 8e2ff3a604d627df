#include "service/sensor_port.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/printable.h"
#include "sensor/load.h"

namespace capsoc::service {
namespace {

/// Where the shaft is follows from its speed and the time since the start: another speed would move
/// it at once.
bool moves_the_shaft(const std::string& key) {
  return key.rfind("motion.", 0) == 0;
}

/// A value of each name, the newest.
void put(std::vector<sensor::KeyValue>& keys, const sensor::KeyValue& newest) {
  const auto old = std::find_if(keys.begin(), keys.end(), [&](const sensor::KeyValue& key) {
    return key.name == newest.name;
  });
  if (old == keys.end())
    keys.push_back(newest);
  else
    *old = newest;
}

}  // namespace

std::optional<sensor::SensorValue> SensorPort::sample(uint64_t k, double t_seconds) {
  course_.newest_s = t_seconds;
  auto value = current_->sample(k, course_.at(t_seconds));
  if (injected_.empty()) return value;
  sensor::SensorValue injected;
  injected.u = injected_.front().first;
  injected.v = injected_.front().second;
  injected_.pop_front();
  return injected;
}

std::optional<Error> SensorPort::change(const std::vector<sensor::KeyValue>& keys) {
  std::vector<sensor::KeyValue> all = keys_, changed = changed_;
  for (const sensor::KeyValue& key : keys) {
    if (moves_the_shaft(key.name))
      return Error{
          fmt::format("{}: the motion cannot be changed while the shaft turns; describe it "
                      "when the simulation is constructed (motion.kind: profile)",
                      printable(key.name, 80))};
    put(all, key);
    put(changed, key);
  }
  auto source = sensor::load(file_, all, options_);
  if (!source) return Error{source.error()};
  current_ = std::move(source.value());
  keys_ = std::move(all);
  changed_ = std::move(changed);
  return std::nullopt;
}

std::optional<Error> SensorPort::set_speed(double factor) {
  constexpr double fastest = 1000;
  using sensor::MotionKind;
  const MotionKind motion = description().motion;
  if (!(factor >= 0 && factor <= fastest))
    return Error{fmt::format("sensor.speed: the factor has to be from 0 to {}", fastest)};
  if (motion == MotionKind::recorded || motion == MotionKind::shuffled ||
      motion == MotionKind::walk)
    return Error{fmt::format(
        "sensor.speed: the samples of a sensor whose motion is '{}' do not depend on time",
        sensor::name_of(motion))};
  course_ = {factor, course_.newest_s, course_.at(course_.newest_s), course_.newest_s};
  return std::nullopt;
}

void SensorPort::inject(const std::vector<double>& u, const std::vector<double>& v) {
  for (std::size_t i = 0; i < u.size(); ++i) injected_.emplace_back(u[i], v[i]);
}

}  // namespace capsoc::service
