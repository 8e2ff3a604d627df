// What a program wrote into its vector table that is no vector.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "run/program_view.h"
#include "soc/soc.h"

namespace capsoc::run {

/// On this board the table lies in RAM at 0, where every null pointer leads: no fault stops such a
/// write. The first is told as the guest's error, the newest ones are kept for the report of a
/// failure.
class VectorReport {
 public:
  VectorReport(soc::Soc& soc, const ProgramView& view);
  VectorReport(const VectorReport&) = delete;
  VectorReport& operator=(const VectorReport&) = delete;

  /// A line for each, indented by four; "" if there was none.
  const std::string& text() const { return text_; }

  void visit(kit::Archive& archive);

 private:
  void listen();
  void written(const cortex_m3::VectorWrite& write);
  bool is_vector(const cortex_m3::VectorWrite& write) const;

  soc::Soc& soc_;
  const ProgramView& view_;
  std::string text_;
  unsigned lines_ = 0;
};

}  // namespace capsoc::run
