#include "explain/program_view.h"

#include <fmt/format.h>

#include "base/printable.h"
#include "loader/demangle.h"
#include "trace/exception_name.h"

namespace capsoc::run {
namespace {

constexpr std::size_t longest_stack = 64;  // frames; a recursion is one line
constexpr uint32_t first_exc_return = 0xFFFFFFE0;

/// EXC_RETURN (B1.5.8).
std::string exc_return_text(uint32_t value) {
  switch (value & 0xF) {
    case 0x1:
      return "EXC_RETURN to a handler";
    case 0x9:
      return "EXC_RETURN to Thread mode on MSP";
    case 0xD:
      return "EXC_RETURN to Thread mode on PSP";
    default:
      return "";
  }
}

std::string name_of(const source::CallFrame& frame) {
  if (frame.exception != 0)
    return fmt::format("-- exception {} ({}), its frame on {}, interrupted", frame.exception,
                       trace::exception_name(frame.exception), frame.process_stack ? "PSP" : "MSP");
  return source::to_text(frame.place) + (frame.place.inlined ? " (inlined)" : "");
}

/// The same place again, of another call.
bool recurses(const source::CallFrame& outer, const source::CallFrame& inner) {
  return outer.exception == 0 && outer.address == inner.address &&
         outer.stack_pointer != inner.stack_pointer;
}

}  // namespace

ProgramView::ProgramView(soc::Soc& soc, const std::vector<const loader::ElfImage*>& images)
    : soc_(soc), program_(images) {}

std::optional<uint32_t> ProgramView::read_word(uint32_t address) const {
  uint8_t bytes[4] = {};
  if (!soc_.read_memory(address, bytes, sizeof bytes)) return std::nullopt;
  return bytes[0] | bytes[1] << 8 | bytes[2] << 16 | static_cast<uint32_t>(bytes[3]) << 24;
}

armv7m::InterruptedRegisters ProgramView::registers() const {
  const armv7m::State& state = soc_.cpu.core().state();
  armv7m::InterruptedRegisters registers{state.r, state.msp(), state.psp(), state.ipsr};
  registers.r[15] = state.pc;
  return registers;
}

source::CallStack ProgramView::call_stack(const armv7m::InterruptedRegisters& registers) const {
  return program_.call_stack(
      registers, [this](uint32_t address) { return read_word(address); }, longest_stack);
}

std::string ProgramView::place(uint32_t address) const {
  const std::string symbol = program_.symbol_at(address);
  const std::vector<source::Place> places = program_.places_at(address);
  std::string text = fmt::format("{:#010x}", address);
  if (!symbol.empty()) text += "  " + symbol;
  if (!places.empty())
    if (const std::string line = source::to_text(places.front().at); !line.empty())
      text += ", " + line;
  return text;
}

std::string ProgramView::here() const {
  constexpr std::size_t most = 4;
  const armv7m::InterruptedRegisters now = registers();
  const std::string symbol = program_.symbol_at(now.r[15]);
  std::string text = fmt::format("pc {:#010x} {}", now.r[15], symbol);
  const source::CallStack stack = program_.call_stack(
      now, [this](uint32_t address) { return read_word(address); }, most);
  for (std::size_t i = 0; i < stack.frames.size(); ++i) {
    const source::CallFrame& frame = stack.frames[i];
    if (i == 0) {
      if (const std::string line = source::to_text(frame.place.at); !line.empty())
        text += ", " + line;
    } else {
      text += frame.exception != 0 ? fmt::format("; in {}", trace::exception_name(frame.exception))
                                   : "; from " + source::to_text(frame.place);
    }
  }
  if (const std::string lost = lost_stack(now.r[13]); !lost.empty()) text += "; " + lost;
  return text;
}

/// A text of the program's in quotes, "" if there is none.
std::string ProgramView::text_at(uint32_t address) const {
  constexpr uint32_t longest = 41, shortest = 3;
  std::string text;
  for (uint8_t byte = 0; text.size() < longest && soc_.read_memory(address, &byte, 1); ++address) {
    if (byte == 0) return text.size() < shortest ? "" : fmt::format("\"{}\"", printable(text));
    const bool printed = (byte >= 0x20 && byte < 0x7F) || byte == '\n' || byte == '\r';
    if (!printed) return "";
    text += static_cast<char>(byte);
  }
  return text.size() < longest ? "" : fmt::format("\"{}\"", printable(text));
}

std::string ProgramView::location(uint32_t address) const {
  const bus::MapEntry* above = nullptr;
  for (const bus::MapEntry& entry : soc_.ahb.map()) {
    if (entry.kind == bus::TargetKind::unimplemented) continue;
    if (address >= entry.base && address <= entry.last())
      return fmt::format("{}+{:#x}", entry.name, address - entry.base);
    if (entry.base > address && (above == nullptr || entry.base < above->base)) above = &entry;
  }
  constexpr uint32_t private_first = 0xE0000000, private_last = 0xE00FFFFF;
  if (address >= private_first && address <= private_last) return "the processor's own registers";
  constexpr uint32_t near = 1U << 20U;
  if (above != nullptr && above->base - address <= near)
    return fmt::format("no memory and no device: {} bytes below {}", above->base - address,
                       above->name);
  return "no memory and no device";
}

std::string ProgramView::lost_stack(uint32_t stack_pointer) const {
  // A stack that is empty stands after its memory.
  if (read_word(stack_pointer) || read_word(stack_pointer - 4)) return "";
  return fmt::format("the stack pointer is {:#010x}, {}: the stack has overflowed, or was lost",
                     stack_pointer, location(stack_pointer));
}

std::string ProgramView::pointed_at(uint32_t value) const {
  constexpr uint32_t vectors = 0x100, plain_number = 0x20000000;
  if (value >= first_exc_return) return exc_return_text(value);
  if (value < vectors) return "";
  const loader::Symbol* symbol = program_.object_at(value);
  if (symbol != nullptr && symbol->is_code) {
    const std::string line = program_.describe(value & ~1u);
    return (value & 1) != 0 && symbol->address == (value & ~1u) ? line : "";
  }
  if (symbol != nullptr) {
    const std::string text = text_at(value);
    const auto word = read_word(value & ~3u);
    std::string about = program_.symbol_at(value);
    if ((value & 1) != 0)
      about = fmt::format("{}+{:#x}", loader::demangled(symbol->name), value - symbol->address);
    if (!text.empty()) return about + " = " + text;
    return word ? fmt::format("{} = {:#010x}", about, *word) : about;
  }
  if (std::string text = text_at(value); !text.empty()) return text;
  if (value < plain_number) return "";
  const std::string where = location(value);
  return where.rfind("no ", 0) == 0 ? "" : where;
}

std::string ProgramView::text_of(const source::CallStack& stack) const {
  std::string text;
  std::size_t number = 0;
  for (std::size_t i = 0; i < stack.frames.size(); ++i) {
    const source::CallFrame& frame = stack.frames[i];
    if (frame.exception != 0) {
      text += fmt::format("    {}\n", name_of(frame));
      continue;
    }
    text += fmt::format("    #{:<3} {:#010x}  {}{}\n", number++, frame.address, name_of(frame),
                        frame.guessed ? "  (its caller by its code)" : "");
    const std::size_t first = i;
    while (i + 1 < stack.frames.size() && recurses(stack.frames[i + 1], stack.frames[i])) ++i;
    number += i - first;
    if (i != first) text += fmt::format("         the same {} times more\n", i - first);
  }
  if (!stack.end.empty()) text += fmt::format("         {}\n", stack.end);
  return text;
}

std::string ProgramView::text_of(const armv7m::InterruptedRegisters& registers) const {
  static constexpr const char* names[] = {"r0", "r1", "r2",  "r3",  "r4",  "r5", "r6", "r7",
                                          "r8", "r9", "r10", "r11", "r12", "sp", "lr", "pc"};
  std::string text;
  const auto line = [&text](const char* name, uint32_t value, const std::string& about) {
    text += fmt::format("    {:<4} {:#010x}{}{}\n", name, value, about.empty() ? "" : "  ", about);
  };
  for (unsigned n = 0; n < 13; ++n) line(names[n], registers.r[n], pointed_at(registers.r[n]));
  const uint32_t lr = registers.r[14];
  line("sp", registers.r[13], location(registers.r[13]));
  line("lr", lr, lr >= first_exc_return ? exc_return_text(lr) : program_.describe(lr, true));
  line("pc", registers.r[15], program_.describe(registers.r[15]));
  line("msp", registers.msp, "");
  line("psp", registers.psp, "");
  return text;
}

std::string ProgramView::gaps() const {
  std::string text;
  for (const std::string& sentence : program_.gaps()) text += fmt::format("  note: {}\n", sentence);
  return text;
}

}  // namespace capsoc::run
