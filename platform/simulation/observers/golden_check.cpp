#include "observers/golden_check.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "capsoc_registers.h"

namespace capsoc::run {
namespace {

namespace golden_registers = registers::coprocessor;

golden::GoldenSettings golden_settings(soc::Soc& soc) {
  constexpr uint32_t base = golden_registers::base_address;
  golden::GoldenSettings settings;
  settings.paper =
      (soc.peek(base + golden_registers::STATUS_offset) & golden_registers::STATUS_ARITH_mask) != 0;
  for (uint32_t offset = golden_registers::STEP_AU_offset;
       offset <= golden_registers::STEP_CV_offset; offset += 4) {
    const double step = soc.peek(base + offset) / q31;
    if (step == 0) continue;
    settings.largest_step = std::max(settings.largest_step, step);
    settings.smallest_step =
        settings.smallest_step == 0 ? step : std::min(settings.smallest_step, step);
  }
  const auto bits = static_cast<int>(soc.adc.bits.get());
  // 32 bits stand for a converter without steps (fit/record.h).
  if (bits < 32) settings.converter_step = std::ldexp(1.0, 1 - bits);
  return settings;
}

}  // namespace

std::optional<Error> GoldenCheck::open() {
  keeping_ =
      samples_.listen([this](const metrics::RecordedSample& sample) { record_.push_back(sample); });
  return std::nullopt;
}

void GoldenCheck::finish(RunResult& result) {
  result.golden = golden::compare(record_, result.words, golden_settings(soc_));
  const golden::AngleCheck& angle = result.golden->angle;
  if (angle.verdict != golden::AngleCheck::Verdict::disagrees || result.code != exit_code::pass)
    return;
  result.code = exit_code::failed;
  result.reason = angle.reason;
}

}  // namespace capsoc::run
