#include "observers/verdict_check.h"

#include <fmt/format.h>

#include "metrics/program_verdict.h"

namespace capsoc::run {

void VerdictCheck::finish(RunResult& result) {
  result.verdict = metrics::read_verdict(
      program_,
      [this](uint32_t address, void* bytes, uint32_t size) {
        return soc_.read_memory(address, bytes, size);
      },
      metrics_);
  if (!result.verdict || result.verdict->bound_holds().value_or(true) ||
      result.code != exit_code::pass)
    return;
  result.code = exit_code::failed;
  result.reason = fmt::format("the program guarantees {:.3g} deg, but an angle is {:.3g} deg wrong",
                              result.verdict->bound_deg, *result.verdict->largest_error_deg);
}

}  // namespace capsoc::run
