#include "workers/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "host/console.h"

namespace capsoc::workers {
namespace {

constexpr auto between_lines = std::chrono::seconds(30);  // of a log

double seconds(std::chrono::steady_clock::duration time) {
  return std::chrono::duration<double>(time).count();
}

}  // namespace

std::string duration_text(double seconds) {
  constexpr double longest = 1e9;  // the rate of the first moments may be nothing
  const auto whole = static_cast<uint64_t>(std::llround(std::clamp(seconds, 0.0, longest)));
  if (whole >= 3600) return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
  if (whole >= 60) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} s", whole);
}

Progress::Progress(uint64_t total, double work)
    : terminal_(isatty(STDERR_FILENO) != 0), total_(total), work_(work) {}

std::string Progress::line(std::size_t running) const {
  const double elapsed = seconds(Clock::now() - begin_);
  const double rate = elapsed > 0 ? static_cast<double>(done_) / elapsed : 0;
  std::string text = fmt::format("{} of {} runs, {} running, {:.3g} runs/s, {} failed", done_,
                                 total_, running, rate, failed_);
  if (work_done_ > 0 && done_ < total_)
    text += fmt::format(", {} left", duration_text((work_ - work_done_) * elapsed / work_done_));
  return text;
}

void Progress::update(std::size_t running) {
  if (terminal_) return host::say("\r{:<100}", line(running));
  if (Clock::now() - last_ < between_lines) return;
  last_ = Clock::now();
  host::say("{}\n", line(running));
}

void Progress::finish() {
  host::say("{}{} in {}\n", terminal_ ? "\r" : "", line(0),
            duration_text(seconds(Clock::now() - begin_)));
}

}  // namespace capsoc::workers
