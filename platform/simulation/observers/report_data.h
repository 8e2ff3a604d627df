// What a report draws of a run (--html, --curves).
#pragma once

#include <optional>

#include "cmsdk/uart.h"
#include "kit/probe.h"
#include "metrics/sample_curves.h"
#include "metrics/sample_record.h"
#include "observers/run_observer.h"
#include "observers/uart_text.h"

namespace capsoc::run {

/// Gathers the curves of the samples and the text of a UART, in memory that does not grow with the
/// run.
class ReportGatherer final : public RunObserver {
 public:
  ReportGatherer(metrics::SampleProbe& samples, cmsdk::Uart& uart)
      : samples_(samples), uart_(uart) {}

  std::optional<Error> open() override;
  const char* gathered() const override { return "report"; }
  void visit_gathered(Archive& archive) override;
  /// Calibrates the curves by the words of the result.
  void finish(RunResult& result) override;

 private:
  metrics::SampleProbe& samples_;
  cmsdk::Uart& uart_;
  metrics::SampleCurves curves_;
  UartText text_;
  kit::Listening drawing_;
};

}  // namespace capsoc::run
