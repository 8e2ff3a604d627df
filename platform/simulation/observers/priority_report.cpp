#include "observers/priority_report.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "kit/guest_error.h"

namespace capsoc::run {
namespace {

constexpr unsigned most_bits = 8;
constexpr const char* source = "cpu: priority bits";

/// As the manual names it (B3.2.10 to B3.2.12, B3.4.9, B1.4.3).
std::string register_name(uint32_t address) {
  constexpr uint32_t ipr0 = 0xE000E400, shpr1 = 0xE000ED18;
  if (address == 0) return "BASEPRI";
  if (address >= shpr1) return fmt::format("SHPR{}", 1 + (address - shpr1) / 4);
  return fmt::format("IPR{}", (address - ipr0) / 4);
}

}  // namespace

std::optional<Error> PriorityReport::open() {
  if (soc_.cpu.core().priority_bits() == most_bits) return std::nullopt;
  soc_.cpu.core().listeners().priority = [this](const armv7m::DroppedPriority& d) { dropped(d); };
  return std::nullopt;
}

void PriorityReport::dropped(const armv7m::DroppedPriority& dropped) {
  const armv7m::Profile& processor = soc_.cpu.core().profile();
  const unsigned bits = soc_.cpu.core().priority_bits();
  const bool can_be_more = bits < processor.most_priority_bits;
  const char* owner = !can_be_more ? processor.product : bits == 3 ? "AN385" : "processor";
  const std::string text =
      fmt::format("{} = {:#x}: the {} has {} priority bits, the rest is dropped{}",
                  register_name(dropped.address), dropped.value, owner, bits,
                  can_be_more ? "; QEMU's board has 8: -C cpu.priority_bits=8" : "");
  if (!dropped.all_ones) {
    warned_ = true;
    return kit::guest_error(source, text);
  }
  probe_ = fmt::format("{} ({})", text, view_.here());
  kit::guest_note(source, text);
}

void PriorityReport::finish(RunResult& result) {
  if (result.code == exit_code::pass || warned_ || probe_.empty()) return;
  spdlog::warn("{}: {}", source, probe_);
}

}  // namespace capsoc::run
