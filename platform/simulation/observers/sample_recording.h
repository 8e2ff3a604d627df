// The recording of a run's samples (--record).
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "base/result.h"
#include "kit/probe.h"
#include "metrics/sample_record.h"
#include "metrics/sample_writer.h"
#include "observers/run_observer.h"
#include "results/result_settings.h"

namespace capsoc::run {

/// Before anything is opened. An Error: unknown columns, or columns without a recording.
std::optional<Error> check_recording(const ResultSettings& settings);

/// Writes each sample to the file of results.record while the run lasts.
class SampleRecording final : public RunObserver {
 public:
  /// `origin`: the comment of the file.
  SampleRecording(const ResultSettings& settings, std::string origin,
                  metrics::SampleProbe& samples);

  std::optional<Error> open() override;
  void close(RunResult& result) override;

 private:
  const ResultSettings& settings_;
  std::string origin_;
  metrics::SampleProbe& samples_;
  std::unique_ptr<metrics::SampleWriter> writer_;
  std::optional<double> since_s_;  ///< its first sample
  kit::Listening listening_;
};

}  // namespace capsoc::run
