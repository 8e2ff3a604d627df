#include "backend/coprocessor_settings.h"

namespace capsoc::run {

coprocessor::Options CoprocessorSettings::options() const {
  coprocessor::Options options;
  options.arithmetic = arithmetic();
  options.paper_operand_bits = static_cast<int>(paper_operand_bits());
  options.paper_reference_lead = static_cast<int>(paper_reference_lead());
  options.paper_step_shift = static_cast<int>(paper_step_shift());
  options.paper_plain_arctangent = paper_plain_arctangent();
  options.paper_iteration_clocks = static_cast<int>(paper_iteration_clocks());
  options.channels = static_cast<int>(channels());
  return options;
}

}  // namespace capsoc::run
