#include "sensor/toml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/constants.h"
#include "base/nearest.h"
#include "base/printable.h"
#include "base/toml.h"
#include "sensor/overrides.h"
#include "sensor/text.h"

namespace capsoc::sensor {
namespace {

/// Legal values, both ends included.
struct Range {
  double least, greatest;
};
constexpr Range amplitude_range{1e-6, 10.0};
constexpr Range offset_range{-10.0, 10.0};
constexpr Range radian_range{-two_pi, two_pi};
constexpr Range share_range{0.0, 10.0};
constexpr Range rate_range{1e-3, 1e7};
constexpr Range frequency_range{-1e6, 1e6};
constexpr Range positive_frequency_range{1e-6, 1e6};
constexpr Range time_range{0.0, 1e9};
constexpr Range drift_range{-1.0, 1.0};
constexpr Range course_range{1e-3, 1e9};
constexpr int64_t longest_record = 10'000'000;  // 0.6 s to find the peaks of both channels

std::string nearest_key(std::string_view word, const std::vector<std::string>& known) {
  // A word of a megabyte has no near neighbour worth a quadratic search.
  return nearest_names(word.substr(0, 64), known);
}

/// Where a node stands: a line of the file, or what set it from outside.
struct Places {
  const std::string& file;
  const Overrides& overrides;

  Error error(const toml::node* node, const std::string& message) const {
    const std::string* origin = node != nullptr ? overrides.origin_of(*node) : nullptr;
    if (origin != nullptr) return Error{fmt::format("{}: {}", *origin, message)};
    const unsigned long line = node != nullptr ? node->source().begin.line : 1;
    return error_at(file, std::max(line, 1UL), message);
  }
};

/// One table of the file. Keeps the first error; after that it reads nothing more.
class TableReader {
 public:
  TableReader(const toml::table* table, std::string name, std::vector<std::string> known,
              const Places& places, std::optional<Error>& error)
      : table_(table),
        name_(std::move(name)),
        known_(std::move(known)),
        places_(places),
        error_(error) {
    if (table_) check_keys();
  }

  bool has(const char* key) const { return table_ && table_->contains(key); }

  void number(const char* key, double& target, Range range) {
    const toml::node* node = find(key);
    if (!node) return;
    const std::optional<double> value = node->value<double>();
    if (!node->is_number() || !value) return fail(*node, key, "is not a number", "write a number");
    if (!std::isfinite(*value)) {
      return fail(*node, key, "is not finite", "write a finite number");
    }
    if (*value < range.least || *value > range.greatest) {
      return fail(*node, key, fmt::format("= {} is out of range", *value),
                  fmt::format("it must lie between {} and {}", range.least, range.greatest));
    }
    target = *value;
  }

  void number(const char* key, std::optional<double>& target, Range range) {
    if (!has(key)) return;
    double value = 0.0;
    number(key, value, range);
    target = value;
  }

  template <typename Integer>
  void integer(const char* key, Integer& target, int64_t least, int64_t greatest) {
    const toml::node* node = find(key);
    if (!node) return;
    if (!node->is_integer()) return fail(*node, key, "is not an integer", "write a whole number");
    const int64_t value = node->as_integer()->get();
    if (value < least || value > greatest) {
      return fail(*node, key, fmt::format("= {} is out of range", value),
                  fmt::format("it must lie between {} and {}", least, greatest));
    }
    target = static_cast<Integer>(value);
  }

  void text(const char* key, std::string& target) {
    const toml::node* node = find(key);
    if (!node) return;
    if (!node->is_string()) return fail(*node, key, "is not a text", "put it in quotes");
    target = node->as_string()->get();
  }

  const toml::table* table(const char* key) {
    const toml::node* node = find(key);
    if (node && !node->is_table()) {
      fail(*node, key, "is not a table", fmt::format("write [{}]", key));
      return nullptr;
    }
    return node ? node->as_table() : nullptr;
  }

  const toml::array* array_of_tables(const char* key) {
    const toml::node* node = find(key);
    if (!node) return nullptr;
    const toml::array* array = node->as_array();
    bool right = array != nullptr;
    if (array) {
      for (const toml::node& element : *array) right = right && element.is_table();
    }
    if (right) return array;
    fail(*node, key, "is not a list of tables", fmt::format("write [[{}]]", key));
    return nullptr;
  }

  void require(std::initializer_list<const char*> keys) {
    for (const char* key : keys) {
      if (has(key)) continue;
      set(places_.error(table_, fmt::format("'{}' is missing in {}; add it", key, where())));
    }
  }

  /// Exactly one of two keys.
  void require_one_of(const char* one, const char* other) {
    if (has(one) && has(other)) {
      return fail(other, fmt::format("stands beside '{}'", one), "keep one of the two");
    }
    if (has(one) || has(other)) return;
    set(places_.error(table_, fmt::format("'{}' or '{}' is missing in {}; add one of them", one,
                                          other, where())));
  }

  void fail(const toml::node& node, std::string_view key, const std::string& wrong,
            const std::string& remedy) {
    set(places_.error(&node, fmt::format("'{}' in {} {}; {}", key, where(), wrong, remedy)));
  }
  void fail(const char* key, const std::string& wrong, const std::string& remedy) {
    if (const toml::node* node = find(key)) fail(*node, key, wrong, remedy);
  }

 private:
  const toml::node* find(const char* key) const { return table_ ? table_->get(key) : nullptr; }

  std::string where() const { return name_.empty() ? "the top level" : fmt::format("[{}]", name_); }

  void check_keys() {
    // A table iterates in the order of its keys; the first wrong one in the file is reported.
    const toml::key* wrong = nullptr;
    const toml::node* wrong_node = nullptr;
    for (const auto& [key, node] : *table_) {
      bool is_known = false;
      for (const std::string& name : known_) is_known = is_known || name == key.str();
      if (is_known) continue;
      if (wrong && key.source().begin.line >= wrong->source().begin.line) continue;
      wrong = &key;
      wrong_node = &node;
    }
    if (!wrong) return;
    const Error error =
        places_.overrides.origin_of(*wrong_node) != nullptr
            ? places_.error(wrong_node, unknown_key(*wrong))
            : error_at(places_.file, wrong->source().begin.line, unknown_key(*wrong));
    set(error);
  }

  std::string unknown_key(const toml::key& wrong) const {
    return fmt::format("unknown key '{}' in {}; the nearest known are {}", printable(wrong.str()),
                       where(), nearest_key(wrong.str(), known_));
  }

  void set(Error error) {
    if (!error_) error_ = std::move(error);
  }

  const toml::table* table_;
  std::string name_;
  std::vector<std::string> known_;
  const Places& places_;
  std::optional<Error>& error_;
};

class SignalReader {
 public:
  SignalReader(const toml::table& root, const Places& places) : root_(root), places_(places) {}

  Result<SignalConfig> read() {
    TableReader top = reader(&root_, "",
                             {"name", "origin", "sampling", "signal", "motion", "drift",
                              "harmonics", "noise", "speed_disturbance"});
    top.require({"name", "signal", "motion"});
    top.text("name", config_.name);
    top.text("origin", config_.origin);
    read_sampling(top.table("sampling"));
    read_signal(top.table("signal"));
    read_motion(top.table("motion"));
    read_drift(top.table("drift"));
    read_harmonics(top.array_of_tables("harmonics"));
    read_noise(top.table("noise"));
    read_speed_disturbance(top.table("speed_disturbance"));
    if (error_) return *error_;
    return config_;
  }

 private:
  TableReader reader(const toml::table* table, const char* name, std::vector<std::string> known) {
    return TableReader(table, name, std::move(known), places_, error_);
  }

  void read_sampling(const toml::table* table) {
    TableReader in = reader(table, "sampling", {"rate_hz", "samples", "adc_bits"});
    in.number("rate_hz", config_.sample_rate_hz, rate_range);
    in.integer("adc_bits", config_.adc_bits, 12, 32);
    if (!in.has("samples")) return;
    uint64_t samples = 0;
    in.integer("samples", samples, 1, 1'000'000'000'000);
    config_.samples = samples;
  }

  void read_signal(const toml::table* table) {
    if (!table) return;
    TableReader in = reader(table, "signal", {"a1", "a2", "b1", "b2", "beta_rad", "phi_rad"});
    in.require({"a1", "a2", "b1", "b2", "beta_rad", "phi_rad"});
    in.number("a1", config_.a1, amplitude_range);
    in.number("a2", config_.a2, amplitude_range);
    in.number("b1", config_.b1, offset_range);
    in.number("b2", config_.b2, offset_range);
    in.number("beta_rad", config_.beta, radian_range);
    in.number("phi_rad", config_.phi, radian_range);
  }

  void read_motion(const toml::table* table) {
    if (!table) return;
    MotionConfig& motion = config_.motion;
    if (!read_kind(*table, motion.kind)) return;
    switch (motion.kind) {
      case MotionKind::constant:
      case MotionKind::ripple:
        return read_rotation(table);
      case MotionKind::shuffled: {
        TableReader in = reader(table, "motion", motion_keys(motion.kind));
        in.require({"seed"});
        return in.integer("seed", motion.seed, 0, std::numeric_limits<int64_t>::max());
      }
      case MotionKind::walk: {
        TableReader in = reader(table, "motion", motion_keys(motion.kind));
        in.require({"seed", "step_turns"});
        in.integer("seed", motion.seed, 0, std::numeric_limits<int64_t>::max());
        return in.number("step_turns", motion.step_turns, {0.0, 1.0});
      }
      case MotionKind::swing: {
        TableReader in = reader(table, "motion", motion_keys(motion.kind));
        in.require({"swing_hz", "amplitude_turns"});
        in.number("swing_hz", motion.swing_hz, positive_frequency_range);
        in.number("centre_turns", motion.centre_turns, {-1.0, 1.0});
        return in.number("amplitude_turns", motion.amplitude_turns, {0.0, 1000.0});
      }
      case MotionKind::profile:
        return read_profile(table);
      case MotionKind::recorded:
        return;
    }
  }

  bool read_kind(const toml::table& table, MotionKind& kind) {
    // Only the kind is read here; each kind has its own list of keys.
    std::string word;
    TableReader in = reader(&table, "motion", keys_of(table));
    in.require({"kind"});
    in.text("kind", word);
    if (error_) return false;
    if (const auto known = motion_kind(word)) {
      kind = *known;
      return true;
    }
    const std::vector<std::string> names = {"constant", "ripple", "shuffled",
                                            "walk",     "swing",  "profile"};
    in.fail("kind", fmt::format("= '{}' is not known", printable(word)),
            fmt::format("the nearest known are {}", nearest_key(word, names)));
    return false;
  }

  static std::vector<std::string> keys_of(const toml::table& table) {
    std::vector<std::string> keys;
    for (const auto& [key, node] : table) keys.emplace_back(key.str());
    return keys;
  }

  void read_rotation(const toml::table* table) {
    MotionConfig& motion = config_.motion;
    const bool ripple = motion.kind == MotionKind::ripple;
    TableReader in = reader(table, "motion", motion_keys(motion.kind));
    in.require({"frequency_hz"});
    in.number("frequency_hz", motion.frequency_hz, frequency_range);
    in.number("reference_hz", motion.reference_hz, frequency_range);
    in.number("reverse_at_s", motion.reverse_at_s, time_range);
    if (!ripple) return;
    in.require({"ripple_amplitude", "ripple_hz"});
    in.number("ripple_amplitude", motion.ripple_amplitude, {0.0, 1.0});
    in.number("ripple_hz", motion.ripple_hz, positive_frequency_range);
  }

  void read_profile(const toml::table* table) {
    TableReader in = reader(table, "motion", motion_keys(MotionKind::profile));
    in.require({"speeds"});
    const toml::node* node = table->get("speeds");
    if (error_ || node == nullptr) return;
    const toml::array* points = node->as_array();
    if (points == nullptr || points->empty()) {
      return in.fail(*node, "speeds", "is not a list of [seconds, Hz]", "write [[0, 1], [5, 100]]");
    }
    for (const toml::node& element : *points) {
      if (!read_speed(in, element)) return;
    }
  }

  /// The next point; false after an error.
  bool read_speed(TableReader& in, const toml::node& element) {
    const auto fail = [&](const std::string& wrong, const std::string& remedy) {
      in.fail(element, "speeds", wrong, remedy);
      return false;
    };
    const toml::array* pair = element.as_array();
    const bool numbers =
        pair != nullptr && pair->size() == 2 && pair->at(0).is_number() && pair->at(1).is_number();
    if (!numbers) {
      return fail("has a point that is not two numbers", "write [seconds, Hz]");
    }
    const SpeedPoint point{pair->at(0).value_or(0.0), pair->at(1).value_or(0.0)};
    std::vector<SpeedPoint>& speeds = config_.motion.speeds;
    const auto inside = [](double value, Range range) {  // NaN is not
      return value >= range.least && value <= range.greatest;
    };
    if (!inside(point.time_s, time_range) || !inside(point.speed_hz, frequency_range)) {
      return fail(
          fmt::format("has a point [{}, {}] that is out of range", point.time_s, point.speed_hz),
          fmt::format("times must lie between {} and {}, speeds between {} and {}",
                      time_range.least, time_range.greatest, frequency_range.least,
                      frequency_range.greatest));
    }
    if (speeds.empty() && point.time_s != 0.0) {
      return fail(fmt::format("begins at {} s", point.time_s), "let its first point be at 0 s");
    }
    if (!speeds.empty() && point.time_s <= speeds.back().time_s) {
      return fail(fmt::format("has {} s behind {} s", point.time_s, speeds.back().time_s),
                  "put the points in order of time");
    }
    speeds.push_back(point);
    return true;
  }

  void read_drift(const toml::table* table) {
    if (!table) return;
    DriftConfig& drift = config_.drift;
    TableReader in = reader(
        table, "drift",
        {"a1_per_s", "a2_per_s", "b1_per_s", "b2_per_s", "beta_rad_per_s", "until_s", "period_s"});
    in.require_one_of("until_s", "period_s");
    in.number("a1_per_s", drift.a1, drift_range);
    in.number("a2_per_s", drift.a2, drift_range);
    in.number("b1_per_s", drift.b1, drift_range);
    in.number("b2_per_s", drift.b2, drift_range);
    in.number("beta_rad_per_s", drift.beta, drift_range);
    in.number("until_s", drift.until_s, course_range);
    in.number("period_s", drift.period_s, course_range);
    if (error_) return;
    check_amplitude(in, "a1_per_s", drift.a1);
    check_amplitude(in, "a2_per_s", drift.a2);
  }

  /// A sine takes an amplitude down with either sign of its rate, a straight course with one.
  void check_amplitude(TableReader& in, const char* key, double rate) {
    const DriftConfig& drift = config_.drift;
    const double lost = (drift.period_s ? std::abs(rate) : -rate) * drift.extent_s();
    if (lost < 1.0) return;
    in.fail(key, fmt::format("= {} leaves nothing of the amplitude", rate),
            "make it slower or its course shorter");
  }

  void read_harmonics(const toml::array* array) {
    if (!array) return;
    for (const toml::node& element : *array) {
      TableReader in =
          reader(element.as_table(), "harmonics", {"channel", "order", "amplitude", "phase_rad"});
      Harmonic harmonic;
      std::string channel;
      in.require({"channel", "order", "amplitude"});
      in.text("channel", channel);
      in.integer("order", harmonic.order, 2, 1000);
      in.number("amplitude", harmonic.amplitude, share_range);
      in.number("phase_rad", harmonic.phase_rad, radian_range);
      if (channel != "u" && channel != "v") {
        in.fail("channel", fmt::format("= '{}' is not known", printable(channel)),
                "write \"u\" or \"v\"");
      }
      harmonic.channel = channel == "v" ? Channel::v : Channel::u;
      config_.harmonics.push_back(harmonic);
    }
  }

  void read_noise(const toml::table* table) {
    if (!table) return;
    NoiseConfig& noise = config_.noise;
    TableReader in = reader(table, "noise", {"sigma", "peak", "record_samples", "seed"});
    in.require({"seed"});
    if (in.has("sigma") && in.has("peak")) {
      in.fail("peak", "stands beside 'sigma'", "keep one of the two");
    }
    if (!in.has("peak")) in.require({"sigma"});
    in.number("sigma", noise.sigma, share_range);
    in.number("peak", noise.peak, share_range);
    in.integer("seed", noise.seed, 0, std::numeric_limits<int64_t>::max());
    if (in.has("sigma")) {
      in.fail("record_samples", "only belongs to 'peak'", "remove it");
    } else {
      in.require({"record_samples"});
    }
    in.integer("record_samples", noise.record_samples, 1, longest_record);
  }

  void read_speed_disturbance(const toml::table* table) {
    if (!table) return;
    SpeedDisturbanceConfig& speed = config_.speed_disturbance;
    TableReader in = reader(table, "speed_disturbance", {"scale", "record_samples", "seed"});
    in.require({"scale", "record_samples", "seed"});
    in.number("scale", speed.scale, {0.0, 1.0});
    in.integer("record_samples", speed.record_samples, 1, longest_record);
    in.integer("seed", speed.seed, 0, std::numeric_limits<int64_t>::max());
    if (config_.motion.kind != MotionKind::constant) {
      in.fail("scale", "needs motion of kind 'constant'", "change the motion or remove this table");
    }
  }

  const toml::table& root_;
  const Places& places_;
  SignalConfig config_;
  std::optional<Error> error_;
};

}  // namespace

Result<SignalConfig> read_signal_toml(std::string_view text, const std::string& file,
                                      const std::vector<KeyValue>& keys) {
  toml::parse_result parsed = toml::parse(text, file);
  if (!parsed) {
    std::string reason(parsed.error().description());
    for (char& c : reason) {
      if (c < 0x20 || c > 0x7E) c = ' ';
    }
    return error_at(file, parsed.error().source().begin.line,
                    fmt::format("not valid TOML ({}); correct this line", reason));
  }
  Overrides overrides;
  if (auto error = overrides.apply(parsed.table(), keys)) return *error;
  return SignalReader(parsed.table(), {file, overrides}).read();
}

}  // namespace capsoc::sensor
