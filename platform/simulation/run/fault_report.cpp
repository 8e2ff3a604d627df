#include "run/fault_report.h"

#include <fmt/format.h>

namespace capsoc::run {
namespace {

const char* name_of(cortex_m3::FaultReport::Kind kind) {
  using Kind = cortex_m3::FaultReport::Kind;
  switch (kind) {
    case Kind::none:
      return "no fault";
    case Kind::hard_fault:
      return "HardFault";
    case Kind::mem_manage:
      return "MemManage";
    case Kind::bus_fault:
      return "BusFault";
    case Kind::usage_fault:
      return "UsageFault";
    case Kind::lockup:
      return "lockup";
  }
  return "";
}

std::string named(const loader::ElfImage& image, uint32_t address) {
  const std::string name = image.symbolise(address);
  return fmt::format("{:#010x}{}{}", address, name.empty() ? "" : "  ", name);
}

}  // namespace

std::string describe_fault(const cortex_m3::Core& core, const loader::ElfImage& image) {
  // A default handler that gives up faults again: what matters is the fault that it was called for.
  const cortex_m3::FaultReport& report = core.first_fault();
  std::string text =
      fmt::format("fault report: {} (exception {}, {} active before) at cycle {}\n",
                  name_of(report.kind), report.exception, report.nesting, report.cycle);
  const auto line = [&](const char* name, const std::string& value) {
    text += fmt::format("  {:<10} {}\n", name, value);
  };
  const auto word = [](uint32_t value) { return fmt::format("{:#010x}", value); };
  line("cause", cortex_m3::describe_cfsr(report.cfsr, report.hfsr));
  line("address", named(image, report.address));
  line("CFSR", word(report.cfsr));
  line("HFSR", word(report.hfsr));
  line("MMFAR", word(report.mmfar));
  line("BFAR", word(report.bfar));
  constexpr uint32_t stacking_failed = 1u << 4 | 1u << 12;  // MSTKERR, STKERR
  text += (report.cfsr & stacking_failed) == 0 ? "  the stacked frame:\n"
                                               : "  the frame, which could not be stacked whole:\n";
  static constexpr const char* names[] = {"r0", "r1", "r2", "r3", "r12", "lr", "pc", "xpsr"};
  for (unsigned i = 0; i < report.frame.size(); ++i)
    line(names[i], i == 5 || i == 6 ? named(image, report.frame[i]) : word(report.frame[i]));
  if (core.last_fault().cycle != report.cycle)
    line("then",
         fmt::format("{} at {} in cycle {}: {}", name_of(core.last_fault().kind),
                     named(image, core.last_fault().frame[6]), core.last_fault().cycle,
                     cortex_m3::describe_cfsr(core.last_fault().cfsr, core.last_fault().hfsr)));
  text += "  the core now:\n";
  line("pc", named(image, core.reg(15)));
  line("lr", named(image, core.reg(14)));
  line("msp", word(core.state().msp()));
  line("psp", word(core.state().psp()));
  return text;
}

}  // namespace capsoc::run
