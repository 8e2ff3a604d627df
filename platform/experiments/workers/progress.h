// How far many runs are, on standard error: one line that changes on a terminal, plain lines in a
// log.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace capsoc::workers {

class Progress {
 public:
  /// `total` runs are to be done, which are so much work in any unit.
  Progress(uint64_t total, double work);

  void done(bool pass, double work) {
    ++done_;
    work_done_ += work;
    if (!pass) ++failed_;
  }
  /// Says something if it is time.
  void update(std::size_t running);
  /// The last line.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;

  std::string line(std::size_t running) const;

  bool terminal_;
  uint64_t total_, done_ = 0, failed_ = 0;
  double work_, work_done_ = 0;
  Clock::time_point begin_ = Clock::now(), last_ = begin_;
};

/// "3 h 07 min", "2 min 05 s", "8 s".
std::string duration_text(double seconds);

}  // namespace capsoc::workers
