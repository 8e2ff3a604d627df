// The sensor, the converter's samples and their results.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/constants.h"
#include "metrics/sample_record.h"
#include "service/board_verbs.h"

namespace capsoc::service {
namespace {

constexpr std::size_t most_injected = 10'000'000;

Answer inject_samples(Board& board, const Call& call) {
  const std::vector<double> u = call.array("u"), v = call.array("v");
  if (u.size() != v.size())
    return refuse(
        fmt::format("adc.inject: {} values of u and {} of v; give as many", u.size(), v.size()),
        Code::wrong_parameter);
  const auto is_number = [](double value) { return std::isfinite(value); };
  if (!std::all_of(u.begin(), u.end(), is_number) || !std::all_of(v.begin(), v.end(), is_number))
    return refuse("adc.inject: a value is no number", Code::wrong_parameter);
  if (u.size() > most_injected - board.sensor().injected().size())
    return refuse("adc.inject: more than 10,000,000 samples wait; advance until they are taken");
  board.sensor().inject(u, v);
  return {};
}

Answer read_sensor(Board& board, const Call&) {
  const sensor::Description& sensor = board.sensor().description();
  const auto or_null = [](const std::optional<double>& value, double scale = 1) {
    return value ? Json(*value * scale) : Json(nullptr);
  };
  const double speed = board.sensor().speed();
  Answer answer;
  answer.result["parameters"] = {{"a1", or_null(sensor.a1)},
                                 {"a2", or_null(sensor.a2)},
                                 {"b1", or_null(sensor.b1)},
                                 {"b2", or_null(sensor.b2)},
                                 {"beta_rad", or_null(sensor.beta)},
                                 {"phi_rad", or_null(sensor.phi)},
                                 {"frequency_hz", or_null(sensor.frequency_hz, speed)},
                                 {"sample_rate_hz", or_null(sensor.sample_rate_hz)}};
  answer.result["name"] = sensor.name;
  answer.result["motion"] = sensor::name_of(sensor.motion);
  answer.result["speed"] = speed;
  return answer;
}

Answer change_sensor(Board& board, const Call& call) {
  std::vector<sensor::KeyValue> keys;
  for (const auto& [name, value] : call.json("parameters").items()) {
    if (!value.is_string() && !value.is_number())
      return refuse(fmt::format("sensor.set: '{}' has to be a number or a text", name),
                    Code::wrong_parameter);
    const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    keys.push_back({name, text, "sensor.set " + name});
  }
  if (auto error = board.sensor().change(keys)) return refuse(error->text);
  return {};
}

Answer set_speed(Board& board, const Call& call) {
  if (auto error = board.sensor().set_speed(call.number("factor"))) return refuse(error->text);
  return {};
}

/// The range of kept samples that a call asks for, from the first one kept.
struct Range {
  std::size_t begin = 0, end = 0, step = 1;

  std::size_t count() const { return (end - begin + step - 1) / step; }
};
Result<Range> range_of(const Board& board, const Call& call) {
  const std::size_t kept = board.samples().size();
  Range range{0, kept};
  if (call.has("first")) {
    const uint64_t first = call.integer("first");
    if (first < board.first_sample())
      return Error{
          fmt::format("samples.read: the first sample that is kept is {}", board.first_sample())};
    range.begin = static_cast<std::size_t>(std::min<uint64_t>(first - board.first_sample(), kept));
  }
  if (call.has("last"))
    range.begin = kept - static_cast<std::size_t>(
                             std::min<uint64_t>(call.integer("last"), kept - range.begin));
  if (call.has("every")) {
    const uint64_t step = call.integer("every");
    if (step == 0) return Error{"samples.read: every is 0; 1 reads each sample"};
    range.step = static_cast<std::size_t>(std::min<uint64_t>(step, kept + 1));
  }
  if (call.has("most")) {
    const uint64_t most = call.integer("most");
    if (most == 0 || call.has("every"))
      return Error{"samples.read: most is 1 or more, and every is left out"};
    range.step = static_cast<std::size_t>(
        std::max<uint64_t>(1, (range.end - range.begin + most - 1) / most));
  }
  return range;
}

Answer read_samples(Board& board, const Call& call) {
  const auto range = range_of(board, call);
  if (!range) return refuse(range.error());
  std::string names;
  if (call.has("columns"))
    for (const std::string& name : call.texts("columns"))
      names += (names.empty() ? "" : ",") + name;
  else
    names = "t,u,v,angle_deg,found_deg,error_deg";
  const auto columns = metrics::record_columns(names, "samples.read");
  if (!columns) return refuse(columns.error(), Code::wrong_parameter);
  const auto [begin, end, step] = range.value();
  Answer answer;
  answer.result = {{"first", board.first_sample() + begin}, {"count", range.value().count()}};
  Json& object = answer.result["columns"] = Json::object();
  for (const std::size_t column : columns.value()) {
    std::vector<double> values;
    values.reserve(range.value().count());
    const auto first = static_cast<std::size_t>(board.first_sample());
    for (std::size_t i = begin; i < end; i += step)
      values.push_back(metrics::column_value(column, board.samples()[i], first + i)
                           .value_or(std::numeric_limits<double>::quiet_NaN()));
    answer.add_array(object, metrics::column_name(column), values);
  }
  return answer;
}

}  // namespace

std::vector<BoardVerb> sensor_verbs() {
  return {
      {{"adc.inject",
        "The converter's next samples are these instead of the sensor's, one pair a conversion; "
        "then the sensor continues, which turned below them. They have no true angle.",
        {need("u", Type::array, "full scale is 1"), need("v", Type::array, "as many")},
        {}},
       inject_samples,
       Effect::input},
      {{"sensor.read",
        "What is known of the sensor.",
        {},
        {{"parameters", "object",
          "a1, a2, b1, b2 (full scale), beta_rad, phi_rad, frequency_hz, sample_rate_hz; null: not "
          "known, or not one value"},
         {"name", "text", "of its description"},
         {"motion", "text", "how the shaft turns"},
         {"speed", "number", "as sensor.speed; frequency_hz has it in it"}}},
       read_sensor,
       Effect::looks},
      {{"sensor.set",
        "Changes keys of the sensor's description from the next sample on, by the names of "
        "`capsoc run -C sensor.NAME` without their prefix. The motion is none of them.",
        {need("parameters", Type::object, "names and values")},
        {}},
       change_sensor,
       Effect::input},
      {{"sensor.speed",
        "The shaft turns N times as fast as described, from the next sample on and from where it "
        "is. A drift passes as fast.",
        {need("factor", Type::number, "N, from 0 (it stands) to 1000")},
        {}},
       set_speed,
       Effect::input},
      {{"samples.read",
        "What the coprocessor saw and found. The newest 1,000,000 samples are kept.",
        {may("first", Type::integer, "number of the first one wanted, from 0 at the start"),
         may("last", Type::integer, "this many of the newest"),
         may("every", Type::integer, "of these only each N-th, from the first one on: 1"),
         may("most", Type::integer, "instead: each N-th, with the least N that gives no more"),
         may("columns", Type::list,
             "as `capsoc run --record-columns` names them; else t, u, v, angle_deg, found_deg, "
             "error_deg")},
        {{"first", "integer", "number of the first one here"},
         {"count", "integer", "of samples"},
         {"columns", "object", "an array of 64-bit floating-point numbers each; NaN: not known"}}},
       read_samples,
       Effect::looks_after_the_end},
  };
}

}  // namespace capsoc::service
