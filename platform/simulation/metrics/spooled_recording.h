// Recordings whose format needs all samples before the first can be written.
#pragma once

#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "metrics/sample_writer.h"

namespace capsoc::metrics {

/// Keeps the columns of all samples in a nameless temporary file until the end.
class SpooledRecording : public SampleWriter {
 public:
  void add(const RecordedSample& sample) final;
  std::optional<Error> finish() final;

 protected:
  /// `recording.columns` without a true angle that not all samples have.
  explicit SpooledRecording(Recording recording);

  /// Writes the recording from each(). An Error: it could not be written.
  virtual std::optional<Error> write() = 0;

  /// Calls `take` with the time (s) and the values of each sample's columns in order; NaN is an
  /// empty cell.
  void each(const std::function<void(double time_s, const double* values)>& take);

  const Recording& recording() const { return recording_; }
  uint64_t samples() const { return samples_; }
  double last_s() const { return last_s_; }

 private:
  Recording recording_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> spool_;
  std::size_t all_columns_;          ///< in the spool, after the time
  std::vector<std::size_t> places_;  ///< of recording_.columns there
  std::vector<double> row_;
  uint64_t samples_ = 0;
  double last_s_ = 0;
  bool truth_ = true;
  int error_ = 0;  ///< errno of the first failure
};

/// A MAT file of level 5 (scipy, Octave, MATLAB): a column vector of doubles for each column, with
/// its name.
Result<std::unique_ptr<SampleWriter>> begin_mat_recording(Recording recording);

/// A stream of Arm's SDS-Framework, a block a sample, and its metadata next to it. It has u and v
/// as words of 32 bits with their scale, other columns as doubles, the time as time slots of ms, or
/// of us where ms do not do.
Result<std::unique_ptr<SampleWriter>> begin_sds_recording(Recording recording);

/// NAME.sds.yml of NAME.sds and of NAME.0.sds.
std::string sds_metadata_of(const std::string& path);

}  // namespace capsoc::metrics
