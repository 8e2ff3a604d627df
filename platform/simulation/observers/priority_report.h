// What a run says of a program that was written for another number of priority bits.
#pragma once

#include <optional>
#include <string>

#include "explain/program_view.h"
#include "observers/run_observer.h"
#include "soc/soc.h"

namespace capsoc::run {

/// Warns once of priority bits that the program wrote and that are not implemented. If all of them
/// are ones, the program works with any width: 0xFF is the lowest priority of each width, and is
/// written to find out the width (B1.5.4). FreeRTOS's examples have 191 for 0xA0. These are
/// reported at level info. They become a warning only at the end of a run that failed, since the
/// program may have refused the width it found.
class PriorityReport final : public RunObserver {
 public:
  PriorityReport(soc::Soc& soc, const ProgramView& view) : soc_(soc), view_(view) {}

  std::optional<Error> open() override;
  void visit(Archive& archive) override {
    archive("priority_warned", warned_);
    archive("priority_probe", probe_);
  }
  void finish(RunResult& result) override;

 private:
  void dropped(const armv7m::DroppedPriority& dropped);

  soc::Soc& soc_;
  const ProgramView& view_;
  bool warned_ = false;
  std::string probe_;  ///< what to say of ones, "" if there were none
};

}  // namespace capsoc::run
