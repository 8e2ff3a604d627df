// What a program wrote into its vector table that is no vector.
#pragma once

#include <optional>
#include <string>

#include "explain/program_view.h"
#include "observers/run_observer.h"
#include "soc/soc.h"

namespace capsoc::run {

/// On this board the table lies in RAM at 0, where every null pointer leads: no fault stops such a
/// write. The first is reported as a guest error, the newest ones are kept for the report of a
/// failure.
class VectorReport final : public RunObserver {
 public:
  VectorReport(soc::Soc& soc, const ProgramView& view) : soc_(soc), view_(view) {}

  std::optional<Error> open() override;
  void visit(Archive& archive) override;
  std::optional<Finding> finding() const override;

 private:
  void listen();
  void written(const armv7m::VectorWrite& write);
  bool is_vector(const armv7m::VectorWrite& write) const;

  soc::Soc& soc_;
  const ProgramView& view_;
  std::string text_;  ///< a line for each, indented by four
  unsigned lines_ = 0;
};

}  // namespace capsoc::run
