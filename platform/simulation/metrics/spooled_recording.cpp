#include "metrics/spooled_recording.h"

#include <cerrno>
#include <limits>
#include <utility>

#include "host/files.h"

namespace capsoc::metrics {

SpooledRecording::SpooledRecording(Recording recording)
    : recording_(std::move(recording)),
      spool_(std::tmpfile(), &std::fclose),
      all_columns_(recording_.columns.size()),
      row_(all_columns_ + 1) {
  if (spool_ == nullptr) error_ = errno;
}

void SpooledRecording::add(const RecordedSample& sample) {
  constexpr double empty = std::numeric_limits<double>::quiet_NaN();
  row_[0] = sample.time_s;
  for (std::size_t i = 0; i < all_columns_; ++i)
    row_[i + 1] = column_value(recording_.columns[i], sample, samples_).value_or(empty);
  if (error_ == 0 &&
      std::fwrite(row_.data(), sizeof(double), row_.size(), spool_.get()) != row_.size())
    error_ = errno;
  truth_ = truth_ && sample.has_truth;
  last_s_ = sample.time_s;
  ++samples_;
}

void SpooledRecording::each(const std::function<void(double time_s, const double* values)>& take) {
  std::vector<double> values(places_.size());
  if (error_ == 0 && std::fseek(spool_.get(), 0, SEEK_SET) != 0) error_ = errno;
  for (uint64_t k = 0; k < samples_ && error_ == 0; ++k) {
    if (std::fread(row_.data(), sizeof(double), row_.size(), spool_.get()) != row_.size()) {
      error_ = errno != 0 ? errno : EIO;
      return;
    }
    for (std::size_t i = 0; i < places_.size(); ++i) values[i] = row_[places_[i] + 1];
    take(row_[0], values.data());
  }
}

std::optional<Error> SpooledRecording::finish() {
  RecordColumns kept;
  for (std::size_t i = 0; i < all_columns_; ++i) {
    const std::size_t column = recording_.columns[i];
    if (!truth_ && std::string(column_name(column)) == "angle_deg") continue;
    kept.push_back(column);
    places_.push_back(i);
  }
  recording_.columns = std::move(kept);
  if (error_ != 0) return host::cannot_write(recording_.path, error_);
  if (auto error = write()) return error;
  if (error_ != 0) return host::cannot_write(recording_.path, error_);
  return std::nullopt;
}

}  // namespace capsoc::metrics
