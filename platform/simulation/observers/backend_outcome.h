// What a coprocessor other than the model leaves of a run: a difference in lockstep, and waves.
#pragma once

#include <optional>
#include <string>

#include "backend/coprocessor_backend.h"
#include "backend/coprocessor_settings.h"
#include "observers/run_observer.h"
#include "soc/soc.h"

namespace capsoc::run {

/// Stops the simulation where model and RTL differ; completes the waves of the RTL.
class BackendOutcome final : public RunObserver {
 public:
  /// `command`: reproduces the run, for the report of a difference.
  BackendOutcome(CoprocessorBackend& backend, const CoprocessorSettings& settings,
                 const soc::Soc& soc, std::string command);

  std::optional<Error> open() override;
  void close(RunResult& result) override;

 private:
  std::string divergence() const;
  std::optional<Error> write_waves(const std::string& path) const;

  CoprocessorBackend& backend_;
  const CoprocessorSettings& settings_;
  const soc::Soc& soc_;
  std::string command_;
};

}  // namespace capsoc::run
