#include "trace/instruction_trace.h"

#include <fmt/format.h>

#include <iterator>
#include <utility>

#include "armv7m/isa/decoder.h"
#include "trace/exception_name.h"

namespace capsoc::trace {
namespace {

constexpr const char* names[] = {"r0",  "r1",  "r2",   "r3",      "r4",    "r5",     "r6",
                                 "r7",  "r8",  "r9",   "r10",     "r11",   "r12",    "lr",
                                 "msp", "psp", "xpsr", "control", "masks", "basepri"};
constexpr unsigned first_of_fpu = std::size(names);

std::string name_of(unsigned n) {
  if (n < first_of_fpu) return names[n];
  const unsigned single = n - first_of_fpu;
  return single < armv7m::Fpu::registers ? "s" + std::to_string(single) : "fpscr";
}
constexpr uint32_t flags = 0xF80F0000;  // N, Z, C, V, Q and GE of the xPSR

std::string note(uint64_t cycle, double seconds, const std::string& text) {
  return fmt::format("{:>12} {:>14.9f}  {}", cycle, seconds, text);
}

}  // namespace

InstructionTrace::InstructionTrace(std::unique_ptr<LineFile> file, Functions& functions)
    : file_(std::move(file)), functions_(functions) {
  file_->heading(fmt::format("{:>12} {:>14}  {:<8} {:<28} {:<32} {}", "cycle", "time/s", "pc",
                             "place", "instruction", "changed registers"));
}

InstructionTrace::Registers InstructionTrace::registers_of(const armv7m::Core& core) {
  Registers r{};
  for (unsigned n = 0; n <= 12; ++n) r[n] = core.reg(n);
  r[13] = core.reg(14);
  r[14] = core.state().msp();
  r[15] = core.state().psp();
  r[16] = core.state().xpsr() & flags;
  r[17] = core.state().control;
  r[18] = core.state().primask | core.state().faultmask << 1U;
  r[19] = core.state().basepri;
  const armv7m::Fpu& fpu = core.state().fpu;
  for (unsigned n = 0; n < armv7m::Fpu::registers; ++n) r[first_of_fpu + n] = fpu.s(n);
  r[register_count - 1] = fpu.status().bits();
  return r;
}

std::string InstructionTrace::changes(const Registers& now) const {
  static_assert(first_of_fpu + fpu_registers == register_count);
  std::string text;
  for (unsigned n = 0; n < register_count; ++n)
    if (now[n] != before_[n]) text += fmt::format(" {}={:08x}", name_of(n), now[n]);
  return text;
}

const std::string& InstructionTrace::text_of(const armv7m::DecodedOp& op) {
  Text& known = texts_[op.address];
  if (known.text.empty() || known.encoding != op.encoding || known.it_state != op.it_before) {
    known = {op.encoding, op.it_before,
             fmt::format("{:08x} {:<28} {:<32}", op.address, functions_.place(op.address),
                         armv7m::disassemble(op))};
  }
  return known.text;
}

void InstructionTrace::issued(const armv7m::Core& core, const armv7m::DecodedOp&) {
  before_ = registers_of(core);
  issue_cycle_ = core.cycles();
  pending_ = true;
}

void InstructionTrace::retired(const armv7m::Core& core, const armv7m::DecodedOp& op,
                               double seconds) {
  pending_ = false;
  std::string line = note(issue_cycle_, seconds, text_of(op)) + changes(registers_of(core));
  line.erase(line.find_last_not_of(' ') + 1);
  file_->put(std::move(line));
}

void InstructionTrace::entered(unsigned exception, armv7m::Entry how, uint64_t since,
                               double seconds) {
  constexpr const char* hows[] = {"", ", tail-chained", ", late, in place of the one before"};
  file_->put(note(since, seconds,
                  fmt::format("--> exception {} {}{}", exception, exception_name(exception),
                              hows[static_cast<unsigned>(how)])));
}

void InstructionTrace::returned(const armv7m::Core& core, unsigned exception, double seconds) {
  file_->put(note(core.cycles(), seconds,
                  fmt::format("<-- exception {} {}, back to {}", exception,
                              exception_name(exception), functions_.place(core.reg(15)))));
}

void InstructionTrace::started(const armv7m::Core& core, double seconds) {
  file_->put(note(core.cycles(), seconds, "--- reset"));
}

std::optional<Error> InstructionTrace::finish(const armv7m::Core& core, double seconds) {
  if (core.locked_up()) file_->put(note(core.cycles(), seconds, "--- lockup"));
  return file_->finish();
}

}  // namespace capsoc::trace
