#include "explain/fault_report.h"

#include <fmt/format.h>

#include <array>

#include "armv7m/isa/decoder.h"
#include "explain/pending_report.h"
#include "trace/exception_name.h"

namespace capsoc::run {
namespace {

const char* name_of(armv7m::FaultReport::Kind kind) {
  using Kind = armv7m::FaultReport::Kind;
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

std::string word(uint32_t value) {
  return fmt::format("{:#010x}", value);
}

/// Lines of a name and what it is.
class Lines {
 public:
  void add(const char* name, const std::string& value) {
    text_ += fmt::format("  {:<10} {}\n", name, value);
  }
  void add(const std::string& text) { text_ += text; }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

/// Where a data address leads.
std::string about_address(const ProgramView& view, const armv7m::FaultReport& report) {
  const std::string object = view.program().symbol_at(report.address);
  return fmt::format("{}  {}", word(report.address),
                     object.empty() ? view.location(report.address) : object);
}

constexpr uint32_t forced = 1u << 30;

bool keeps_fault_status(const ProgramView& view) {
  return view.soc().cpu.core().profile().has_fault_status;
}

constexpr uint32_t undefined_instruction = 1u << 16, no_coprocessor = 1u << 19;

/// What an instruction that the processor does not have is on one that has it; "" where it is none.
std::string about_missing(const ProgramView& view, const armv7m::FaultReport& report) {
  const armv7m::Core& core = view.soc().cpu.core();
  const uint32_t address = report.registers.r[15];
  std::array<uint16_t, 2> code{};
  if (!core.debug_read(address, code.data(), 2)) return "";
  if (armv7m::is_wide(code[0]) && !core.debug_read(address + 2, &code[1], 2)) return "";
  const armv7m::Profile& profile = core.profile();
  const armv7m::DecodedOp op = armv7m::decode(address, code[0], code[1], 0, armv7m::cortex_m4f);
  const unsigned coprocessor = op.encoding >> 8 & 15;
  const bool for_fpu = coprocessor == 10 || coprocessor == 11;
  if (report.cfsr == no_coprocessor && armv7m::is_wide(code[0])) {
    if (!for_fpu) return "";
    if (profile.has_fpu())
      return " (of the FPU, which the program has not enabled: CPACR, bits 20 to 23)";
    return fmt::format(
        " (of an FPU, which the {} does not have; build with -mfloat-abi=soft, or run it with "
        "-C cpu.profile=m4f)",
        profile.product);
  }
  if (op.operation == armv7m::Operation::undefined ||
      (armv7m::line_of(op).set & profile.instruction_sets) != 0)
    return "";
  const bool dsp = armv7m::line_of(op).set == armv7m::instruction_set::v7em;
  return fmt::format(" ('{}' is of {}Armv7-M; build with -mcpu={})", armv7m::disassemble(op),
                     dsp ? "the DSP extension of " : "", profile.short_name);
}

/// The cause of a fault. Without the registers that tell it, only what happened is left of their
/// bits: neither that an address is held, nor that HardFault stands for another fault.
std::string cause_of(const ProgramView& view, const armv7m::FaultReport& report) {
  const bool lacks = report.cfsr == undefined_instruction || report.cfsr == no_coprocessor;
  const std::string missing = lacks ? about_missing(view, report) : "";
  if (keeps_fault_status(view)) return armv7m::describe_cfsr(report.cfsr, report.hfsr) + missing;
  constexpr uint32_t addresses = 1u << 7 | 1u << 15;
  const uint32_t escalated = report.cfsr != 0 ? forced : 0;
  return armv7m::describe_cfsr(report.cfsr & ~addresses, report.hfsr & ~escalated) + missing;
}

/// Only faults leave a status.
bool is_escalated_svc(const armv7m::FaultReport& report) {
  return report.hfsr == forced && report.cfsr == 0;
}

/// The exception that a fault is of by its status: MemManage, BusFault or UsageFault; SVCall leaves
/// none.
unsigned exception_of(uint32_t cfsr) {
  namespace exception = armv7m::exception;
  if (cfsr == 0) return exception::svcall;
  if ((cfsr & 0xFF) != 0) return exception::mem_manage;
  return (cfsr & 0xFF00) != 0 ? exception::bus_fault : exception::usage_fault;
}

/// Why something became a HardFault.
std::string escalation(const ProgramView& view, const armv7m::FaultReport& report) {
  if (report.hfsr != forced) return "";
  const armv7m::State& state = view.soc().cpu.core().state();
  const unsigned number = exception_of(report.cfsr);
  if (number != armv7m::exception::svcall && !keeps_fault_status(view)) return "";
  const std::string name = trace::exception_name(number);
  if (number != armv7m::exception::svcall && !state.scb.fault_enabled(number))
    return name + " is not enabled (SHCSR)";
  return fmt::format("{} has the priority {:#x}, which does not preempt: {}", name,
                     state.nvic.priority(number), describe_priority(view.soc()));
}

void add_lost_write(const ProgramView& view, const armv7m::FaultReport& report, Lines& lines) {
  const armv7m::LostWrite& write = report.lost_write;
  if (!write.known) return;
  lines.add("write", fmt::format("{} to {}, {}", word(write.value), word(write.address),
                                 view.location(write.address)));
  lines.add("by", fmt::format("{}, in cycle {}", view.place(write.instruction), write.cycle));
}

void add_findings(const Findings& findings, Lines& lines) {
  for (const Finding& finding : findings)
    lines.add(fmt::format("  {}:\n{}", finding.heading, finding.text));
}

}  // namespace

std::string describe_fault(const ProgramView& view, const Findings& findings) {
  // A default handler that gives up faults again: what matters is the fault that it was called for.
  const armv7m::Core& core = view.soc().cpu.core();
  armv7m::FaultReport report = core.first_fault();
  constexpr uint32_t svc_size = 2;  // its frame returns after it
  if (is_escalated_svc(report)) report.registers.r[15] -= svc_size;
  Lines lines;
  lines.add(fmt::format("fault report: {} (exception {}, {} active before) at cycle {}\n",
                        name_of(report.kind), report.exception, report.nesting, report.cycle));
  lines.add("cause", cause_of(view, report));
  if (const std::string why = escalation(view, report); !why.empty()) lines.add("escalated", why);
  add_lost_write(view, report, lines);
  lines.add("at", view.place(report.registers.r[15]));
  if (report.address != report.frame[6]) lines.add("address", about_address(view, report));
  if (const std::string lost = view.lost_stack(report.registers.r[13]); !lost.empty())
    lines.add("stack", lost);
  if (keeps_fault_status(view)) {
    lines.add("CFSR", word(report.cfsr));
    lines.add("HFSR", word(report.hfsr));
    lines.add("MMFAR", word(report.mmfar));
    lines.add("BFAR", word(report.bfar));
  }
  lines.add("  the call stack, innermost first:\n");
  lines.add(view.text_of(view.call_stack(report.registers)));
  constexpr uint32_t stacking_failed = 1u << 4 | 1u << 12;  // MSTKERR, STKERR
  lines.add((report.cfsr & stacking_failed) == 0
                ? "  the registers then:\n"
                : "  the registers then, which could not all be stacked:\n");
  lines.add(view.text_of(report.registers));
  if (core.last_fault().cycle != report.cycle)
    lines.add("then", fmt::format("{} at {} in cycle {}: {}", name_of(core.last_fault().kind),
                                  view.place(core.last_fault().frame[6]), core.last_fault().cycle,
                                  cause_of(view, core.last_fault())));
  add_findings(findings, lines);
  if (const std::string pending = describe_pending(view.soc()); !pending.empty())
    lines.add("  pending and not taken:\n" + pending);
  lines.add("  the core now:\n");
  lines.add("pc", view.place(core.reg(15)));
  lines.add("lr", view.place(core.reg(14)));
  lines.add("msp", word(core.state().msp()));
  lines.add("psp", word(core.state().psp()));
  lines.add(view.gaps());
  return lines.take();
}

std::string describe_place(const ProgramView& view, const Findings& findings) {
  const armv7m::Core& core = view.soc().cpu.core();
  const armv7m::State& state = core.state();
  Lines lines;
  lines.add(fmt::format("the firmware at cycle {}, {}:\n", core.cycles(),
                        core.sleeping() ? "asleep" : "running"));
  lines.add("at", view.place(state.pc));
  if (const std::string lost = view.lost_stack(state.r[13]); !lost.empty())
    lines.add("stack", lost);
  const std::string mode = state.ipsr == 0 ? "Thread mode"
                                           : fmt::format("exception {} ({})", state.ipsr,
                                                         trace::exception_name(state.ipsr));
  lines.add("mode", mode + (state.uses_psp() ? ", on PSP" : ", on MSP"));
  lines.add("  the call stack, innermost first:\n");
  lines.add(view.text_of(view.call_stack(view.registers())));
  const std::string pending = describe_pending(view.soc());
  lines.add("pending", pending.empty() ? "nothing" : "and not taken:");
  lines.add(pending);
  add_findings(findings, lines);
  lines.add(view.gaps());
  return lines.take();
}

std::string describe_line(const serial::SerialLine& uart, const ProgramView& view,
                          const std::string& call_stack) {
  return fmt::format("{} printed: {}\n  from here, innermost first:\n{}{}", uart.name(),
                     uart.match()->line, call_stack, view.gaps());
}

}  // namespace capsoc::run
