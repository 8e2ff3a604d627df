// What the monitors between the parts of the SoC find (soc.monitor).
#pragma once

#include "kit/probe.h"
#include "kit/protocol_watch.h"
#include "observers/run_observer.h"
#include "soc/soc.h"

namespace capsoc::run {

/// Logs the first violations of the TLM-2.0 base protocol, and makes a run with any an internal
/// error: no program may cause one.
class ProtocolViolations final : public RunObserver {
 public:
  explicit ProtocolViolations(soc::Soc& soc) : protocol_(soc.protocol) {}

  std::optional<Error> open() override;
  void finish(RunResult& result) override;

 private:
  kit::ProtocolWatch& protocol_;
  kit::Listening listening_;
};

}  // namespace capsoc::run
