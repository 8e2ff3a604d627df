// What a run says of a program that was written for another number of priority bits.
#pragma once

#include <string>

#include "run/program_view.h"
#include "soc/soc.h"

namespace capsoc::run {

/// Warns once of priority bits that the program wrote and that do not exist. Where they are all
/// ones the program means any width: 0xFF is the lowest priority of each, and how programs find out
/// the width (B1.5.4); FreeRTOS's examples have 191 for 0xA0. These are told at level info, and as
/// a warning only at the end of a run that failed, for a program may have refused the width it
/// found.
class PriorityReport {
 public:
  PriorityReport(soc::Soc& soc, const ProgramView& view, unsigned bits);
  PriorityReport(const PriorityReport&) = delete;
  PriorityReport& operator=(const PriorityReport&) = delete;

  void finish(bool passed);

  void visit(kit::Archive& archive) {
    archive("warned", warned_);
    archive("probe", probe_);
  }

 private:
  void dropped(const cortex_m3::DroppedPriority& dropped);

  soc::Soc& soc_;
  const ProgramView& view_;
  unsigned bits_;
  bool warned_ = false;
  std::string probe_;  ///< what to say of ones, "" if there were none
};

}  // namespace capsoc::run
