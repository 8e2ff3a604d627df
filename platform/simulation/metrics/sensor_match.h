// Whether a program takes the sensor for what it is: its sample rate and its reference's speed
// compared with what is known of the signal.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/archive.h"
#include "sensor/source.h"

namespace capsoc::metrics {

/// How the program had set the coprocessor and the ADC when a result came.
struct SamplingState {
  enum class Reference { numeric, tracking, angle };
  bool demodulating = false;
  Reference reference = Reference::numeric;
  double rate_hz = 0;          ///< of the ADC's samples
  uint32_t period_cycles = 0;  ///< the same as the program can set it, in cycles of its clock
  int32_t frequency = 0;       ///< upper word of FREQ, 2^-32 turn a sample

  void visit(Archive& archive);
};

/// Mean speed of a recording with true angles, in turns a sample, negative: backwards. Nothing for
/// a described signal, without true angles, or where the shaft does not turn steadily in one
/// direction. Rewinds the source.
std::optional<double> recorded_speed(sensor::Source& source);

/// Follows a run result by result and says once, in a sentence, what does not match. A described
/// signal is computed for the time of each sample, so any rate is right for it; a program whose
/// reference is the angle itself needs neither rate nor order nor speed.
class SensorMatch {
 public:
  using Warn = std::function<void(const std::string& sentence)>;

  /// `file` begins the sentences. `speed`: recorded_speed().
  SensorMatch(std::string file, const sensor::Description& description, std::optional<double> speed,
              Warn warn);

  void result(const SamplingState& state);
  /// The sensor starts from its sample 0.
  void restarted() { same_ = 0; }
  void visit(Archive& archive);

  /// The run is over: a record shorter than two turns is judged now.
  void finish();

 private:
  void judge();
  void judge_motion();
  void judge_rate();
  void judge_speed();
  double recorded_rate() const;
  void say(const std::string& sentence);

  std::string file_;
  sensor::Description description_;
  std::optional<double> speed_;
  Warn warn_;
  SamplingState state_;
  uint64_t same_ = 0;  ///< results since the state became what it is
  bool judged_ = false;
};

}  // namespace capsoc::metrics
