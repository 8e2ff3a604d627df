// The newest samples of a run, back to the beginning of the last turn.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "metrics/sample_record.h"

namespace capsoc::metrics {

/// Values of a sample that the plots of a turn need.
struct TurnSample {
  double angle_turns = 0;  ///< true angle; only with has_error
  int32_t u = 0, v = 0;    ///< Q1.31
  uint32_t angle = 0;      ///< the coprocessor's, 2^-32 turn; only with has_result
  bool has_result = false;
  bool has_error = false;  ///< the coprocessor's angle is valid and the true one known

  void visit(Archive& archive);
};

/// Keeps the last turn by the coprocessor's angle, but at least the newest `least` samples, which
/// are enough for a curve of samples in random order, and at most the newest `most`.
class LastTurn {
 public:
  static constexpr std::size_t least = 2000;
  static constexpr std::size_t most = 32768;

  void add(const RecordedSample& sample) {
    const bool has_result = sample.result.has_value();
    samples_.push_back({sample.angle_turns, sample.u, sample.v,
                        has_result ? sample.result->angle : 0, has_result, has_error(sample)});
    if (samples_.size() >= enough_) forget();
  }

  void visit(Archive& archive);

  std::vector<TurnSample> samples() const {
    return {samples_.end() - static_cast<std::ptrdiff_t>(length()), samples_.end()};
  }

 private:
  /// Of the turn, in samples, which are the newest.
  std::size_t length() const;
  /// What is older, seldom enough to cost little.
  void forget();

  std::vector<TurnSample> samples_;
  std::size_t enough_ = 2 * least;
};

}  // namespace capsoc::metrics
