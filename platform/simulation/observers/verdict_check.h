// The verdict that a program states in its memory, and whether the sensor's truth keeps its bound.
#pragma once

#include "loader/elf_image.h"
#include "metrics/metrics.h"
#include "observers/run_observer.h"
#include "soc/soc.h"

namespace capsoc::run {

/// Reads the verdict at the end of the run. A pass whose bound the truth exceeds becomes a failure.
class VerdictCheck final : public RunObserver {
 public:
  VerdictCheck(const loader::ElfImage& program, soc::Soc& soc, const metrics::Metrics& metrics)
      : program_(program), soc_(soc), metrics_(metrics) {}

  void finish(RunResult& result) override;

 private:
  const loader::ElfImage& program_;
  soc::Soc& soc_;
  const metrics::Metrics& metrics_;
};

}  // namespace capsoc::run
