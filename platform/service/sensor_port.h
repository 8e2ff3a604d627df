// The sensor as a session sees it: its parameters can be changed, and samples put in its place.
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "sensor/description_keys.h"
#include "sensor/recording_options.h"
#include "sensor/source.h"

namespace capsoc::service {

/// Laid over the source of a run. What is asked of it takes effect with the next sample.
class SensorPort final : public sensor::Source {
 public:
  /// `file`, `keys` and `options` are what `first` was loaded from.
  SensorPort(std::unique_ptr<sensor::Source> first, std::string file,
             std::vector<sensor::KeyValue> keys, sensor::RecordingOptions options)
      : current_(std::move(first)),
        file_(std::move(file)),
        keys_(std::move(keys)),
        options_(std::move(options)) {}

  std::optional<sensor::SensorValue> sample(uint64_t k, double t_seconds) override;
  void rewind() override {
    current_->rewind();
    course_ = {course_.factor, 0, 0, 0};
  }
  const sensor::Description& description() const override { return current_->description(); }

  /// Lays keys over the description, in addition to those that were laid over it before. An Error:
  /// the sensor is a recording, or one is none that can change while the shaft turns; nothing
  /// changed.
  std::optional<Error> change(const std::vector<sensor::KeyValue>& keys);
  /// From the next sample on the described course passes `factor` times as fast, from where it is:
  /// the motion, and a drift. 0: the shaft stands. An Error: the factor is none from 0 to 1000, or
  /// the course does not depend on time; nothing changed.
  std::optional<Error> set_speed(double factor);
  double speed() const { return course_.factor; }

  /// Which time of the description a sample is of.
  struct Course {
    double factor = 1;
    double from_s = 0, described_s = 0;  ///< since from_s; where the description was then
    double newest_s = 0;                 ///< of the newest sample

    double at(double t_seconds) const { return described_s + factor * (t_seconds - from_s); }
  };
  const Course& course() const { return course_; }
  void set_course(const Course& course) { course_ = course; }

  /// Those that change() was given, the newest value of each.
  const std::vector<sensor::KeyValue>& changed() const { return changed_; }

  /// The next samples are these instead of the sensor's, in units of full scale; time, and the
  /// sensor, continue below them. They have no true angle.
  void inject(const std::vector<double>& u, const std::vector<double>& v);
  const std::deque<std::pair<double, double>>& injected() const { return injected_; }

 private:
  std::unique_ptr<sensor::Source> current_;
  std::string file_;
  std::vector<sensor::KeyValue> keys_, changed_;
  sensor::RecordingOptions options_;
  std::deque<std::pair<double, double>> injected_;  ///< u and v, not taken yet
  Course course_;
};

}  // namespace capsoc::service
