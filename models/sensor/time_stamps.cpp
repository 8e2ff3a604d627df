#include "sensor/time_stamps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace capsoc::sensor {
namespace {

constexpr std::size_t learning_rows = 4096;  // rows that tell the regular step
// A single lost sample doubles its step; what a clock jitters stays below.
constexpr double gap_steps = 1.75;
// Above, stamps are uneven, and no single gap is worth a sentence.
constexpr double most_gaps = 0.05;
constexpr double coarse_part = 0.2;
constexpr double restart_part = 0.02;
constexpr double most_restarts = 0.05;  // of the rows; above, they are in no order

double median(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

void TimeStamps::add(double seconds, unsigned long line) {
  if (learnt_) return take({seconds, line});
  first_.push_back({seconds, line});
  if (first_.size() == learning_rows) learn();
}

void TimeStamps::learn() {
  learnt_ = true;
  std::vector<double> rising;
  std::size_t equal = 0;
  for (std::size_t k = 1; k < first_.size(); ++k) {
    const double step = first_[k].seconds - first_[k - 1].seconds;
    if (step > 0) rising.push_back(step);
    if (step == 0) ++equal;
  }
  coarse_ = !rising.empty() && static_cast<double>(equal) > coarse_part * first_.size();
  step_ = median(rising);
  for (const Stamp& stamp : first_) take(stamp);
  first_ = {};
}

void TimeStamps::take(const Stamp& stamp) {
  if (rows_++ == 0) {
    begin_ = last_ = least_ = most_ = stamp.seconds;
    return;
  }
  const double step = stamp.seconds - last_;
  const Place place = {last_, stamp.seconds, stamp.line};
  if (step < 0) {
    // A clock that begins again falls to where it began.
    if (stamp.seconds > least_ + restart_part * (most_ - least_)) ++small_falls_;
    if (falls_++ == 0) first_fall_ = place;
  } else if (step == 0) {
    if (equal_++ == 0) first_equal_ = place;
  } else if (step > gap_steps * step_) {
    ++gaps_;
    missing_s_ += step - step_;
    if (step > longest_gap_.after - longest_gap_.before) longest_gap_ = place;
  } else {
    regular_sum_ += step;
    ++regular_;
    shortest_ = regular_ == 1 ? step : std::min(shortest_, step);
    longest_regular_ = std::max(longest_regular_, step);
  }
  last_ = stamp.seconds;
  least_ = std::min(least_, last_);
  most_ = std::max(most_, last_);
}

void TimeStamps::remark_on_gaps(Verdict& verdict) const {
  if (gaps_ == 0) return;
  const auto steps = static_cast<double>(rows_ - 1);
  if (static_cast<double>(gaps_) > most_gaps * steps && gaps_ > 1) {
    verdict.remarks.push_back(
        fmt::format("the time stamps are uneven, from {:.6g} to {:.6g} s apart; their median step "
                    "of {:.6g} s is taken for all",
                    shortest_, longest_gap_.after - longest_gap_.before, step_));
    return;
  }
  const double period = 1 / *verdict.rate_hz;
  const double longest = longest_gap_.after - longest_gap_.before;
  std::string sentence = gaps_ == 1 ? "1 gap in the time stamps"
                                    : fmt::format("{} gaps in the time stamps, the longest", gaps_);
  sentence += fmt::format(
      " of {:.6g} s after t = {:.9g} ({} {}): about {:.0f} {} are missing{}; "
      "the {} are taken as if they followed each other",
      longest, longest_gap_.before, place_, longest_gap_.line,
      std::max(1.0, std::round(missing_s_ / period)), things_, gaps_ == 1 ? "" : " in all",
      things_);
  verdict.remarks.push_back(std::move(sentence));
}

void TimeStamps::remark_on_falls(Verdict& verdict) const {
  if (falls_ == 0) return;
  if (small_falls_ > 0 ||
      static_cast<double>(falls_) > most_restarts * static_cast<double>(rows_)) {
    verdict.line = first_fall_.line;
    verdict.error =
        fmt::format("t falls from {} to {}{}; sort the rows by time", first_fall_.before,
                    first_fall_.after, falls_ == 1 ? "" : fmt::format(", as in {} rows", falls_));
    return;
  }
  verdict.remarks.push_back(fmt::format(
      "the clock begins again {} (from t = {:.9g} to {:.9g} in {} {}); the {} are taken "
      "as if they followed each other",
      falls_ == 1 ? "once" : fmt::format("{} times", falls_), first_fall_.before, first_fall_.after,
      place_, first_fall_.line, things_));
}

TimeStamps::Verdict TimeStamps::verdict() {
  if (!learnt_) learn();
  Verdict verdict;
  if (rows_ < 2) return verdict;
  if (regular_ > 0) {
    // As the file says it, where nothing is wrong with it.
    const bool whole = regular_ == rows_ - 1;
    const double count = static_cast<double>(coarse_ ? regular_ + equal_ : regular_);
    const double rate = whole ? count / (last_ - begin_) : count / regular_sum_;
    if (std::isfinite(rate) && rate > 0) verdict.rate_hz = rate;
  }
  remark_on_falls(verdict);
  if (!verdict.error.empty()) return verdict;
  if (!verdict.rate_hz) {
    verdict.remarks.push_back("the time stamps do not rise; the sample rate is not known");
    return verdict;
  }
  remark_on_gaps(verdict);
  if (equal_ > 0 && !coarse_)
    verdict.remarks.push_back(
        fmt::format("{} {} the time stamp of the row before (the first in {} {}, t = {:.9g}): "
                    "doubled rows shift all that follow; remove them",
                    equal_, equal_ == 1 ? "row has" : "rows have", place_, first_equal_.line,
                    first_equal_.after));
  return verdict;
}

}  // namespace capsoc::sensor
