// What the processor did, as the pages draw it.
#pragma once

#include "service/run_session.h"

namespace capsoc::view {

using service::Json;

/// The answer of processor.activity for the window that the pages show.
class TimeLine {
 public:
  double window_s() const { return window_s_; }
  /// For the next question.
  void set_window(double seconds) { window_s_ = seconds; }
  /// An answer that is an error changes nothing.
  void take(const service::Answer& answer);
  /// {"window_s", "begin_ps", "end_ps", "known_ps", "bin_ps", "rows"}: as the method has them.
  /// Arrays are lists, and the times of slices count from begin_ps. Null: not asked yet.
  const Json& shown() const { return shown_; }
  /// The record begins within the window, but the history does not.
  bool lacks(double beginning_s) const;

 private:
  double window_s_ = 0.1;
  Json shown_;
};

}  // namespace capsoc::view
