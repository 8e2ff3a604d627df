// The stopped program as a person wants it told: where it is, who called whom, what a number points
// at.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "loader/elf_image.h"
#include "soc/soc.h"
#include "source/call_stack.h"

namespace capsoc::run {

/// Looks at the SoC and changes nothing in it. It and the programs must outlive it.
class ProgramView {
 public:
  /// `images`: the programs in the order in which they were loaded.
  ProgramView(soc::Soc& soc, const std::vector<const loader::ElfImage*>& images);
  ProgramView(const ProgramView&) = delete;
  ProgramView& operator=(const ProgramView&) = delete;

  const source::Program& program() const { return program_; }
  soc::Soc& soc() const { return soc_; }

  /// The registers as they are now.
  armv7m::InterruptedRegisters registers() const;
  source::CallStack call_stack(const armv7m::InterruptedRegisters& registers) const;

  /// "0x00000124  main+0x12, src/main.c:12" of an instruction; without the address's own name where
  /// it has none.
  std::string place(uint32_t address) const;
  /// For a message: the instruction under way, its line and who called.
  std::string here() const;
  /// What a register's value points at: an object with what it holds, a text, a device, code; ""
  /// where it looks like a plain number.
  std::string pointed_at(uint32_t value) const;
  /// "uart0+0x4", "data_sram+0x10", or how far from memory an address is.
  std::string location(uint32_t address) const;

  /// That a stack pointer is outside all memories, "" if it is not.
  std::string lost_stack(uint32_t stack_pointer) const;

  /// Lines of a report, indented by four.
  std::string text_of(const source::CallStack& stack) const;
  std::string text_of(const armv7m::InterruptedRegisters& registers) const;
  /// A line for each gap in what is known of the programs, indented by two; "" if there is none.
  std::string gaps() const;

 private:
  std::optional<uint32_t> read_word(uint32_t address) const;
  std::string text_at(uint32_t address) const;

  soc::Soc& soc_;
  source::Program program_;
};

}  // namespace capsoc::run
