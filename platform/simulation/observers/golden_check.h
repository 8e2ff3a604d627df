// The golden check of a run (--golden), and what it does to the exit code.
#pragma once

#include <optional>

#include "kit/probe.h"
#include "metrics/sample_record.h"
#include "observers/run_observer.h"
#include "soc/soc.h"

namespace capsoc::run {

/// Keeps all samples in memory, fits them at the end and compares with the coprocessor's words of
/// the result. A pass whose angle disagrees becomes a failure.
class GoldenCheck final : public RunObserver {
 public:
  GoldenCheck(soc::Soc& soc, metrics::SampleProbe& samples) : soc_(soc), samples_(samples) {}

  std::optional<Error> open() override;
  void finish(RunResult& result) override;

 private:
  soc::Soc& soc_;
  metrics::SampleProbe& samples_;
  metrics::SampleRecord record_;
  kit::Listening keeping_;
};

}  // namespace capsoc::run
