// Who called whom, as the stacks of a stopped processor have it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "armv7m/fault_report.h"
#include "loader/elf_image.h"
#include "source/debug_information.h"

namespace capsoc::source {

/// A function that was called, or an exception that interrupted what comes after it.
struct CallFrame {
  uint32_t address = 0;  ///< of the instruction, or where the call returns to
  uint32_t stack_pointer = 0;
  Place place;
  unsigned exception = 0;      ///< not 0: no function, but this exception's entry
  bool process_stack = false;  ///< of an exception: it stacked its frame on PSP
  bool guessed = false;        ///< its caller was found without debug information
};

struct CallStack {
  std::vector<CallFrame> frames;  ///< the innermost first
  std::string end;                ///< why it ends before the outermost function; "" if it does not
};

/// The programs' code as a person knows it: symbols, and debug information where there is some. It
/// is read when something is asked for the first time. The images must outlive it.
class Program {
 public:
  explicit Program(std::vector<const loader::ElfImage*> images) : images_(std::move(images)) {}

  /// Innermost first; a place without debug information has its symbol's name and no line. Empty:
  /// no code of the program's.
  std::vector<Place> places_at(uint32_t address) const;
  /// "main, src/main.c:12"; "" for no code of the program's. Of an address after a call the call.
  std::string describe(uint32_t address, bool returns = false) const;
  /// Of data or code, "name+0x4", or "".
  std::string symbol_at(uint32_t address) const;
  std::optional<SourceLine> line_at(uint32_t address) const;
  const std::vector<const loader::ElfImage*>& images() const { return images_; }
  std::optional<uint32_t> address_of(const std::string& symbol) const;
  std::vector<std::string> symbol_names() const;
  /// The object or function that covers an address, null if none does.
  const loader::Symbol* object_at(uint32_t address) const;

  /// From registers on. What was called is followed through exceptions and both stacks, `most`
  /// frames far.
  CallStack call_stack(const armv7m::InterruptedRegisters& registers, const ReadWord& read,
                       std::size_t most) const;

  /// What of the debug information cannot be read: one sentence for each part.
  std::vector<std::string> damage() const;
  /// That, or what kind of information there is, if it is not all: one sentence for each program.
  std::vector<std::string> gaps() const;
  const std::vector<std::unique_ptr<DebugInformation>>& debug_information() const;

 private:
  bool is_code(uint32_t address) const { return !places_at(address).empty(); }
  const loader::Symbol* function_at(uint32_t address) const;
  Unwound unwind(uint32_t address, Registers& registers, const ReadWord& read, bool& guessed) const;

  std::vector<const loader::ElfImage*> images_;
  mutable std::vector<std::unique_ptr<DebugInformation>> debug_;
};

/// "src/main.c:12", or "".
std::string to_text(const SourceLine& line);
/// "main, src/main.c:12", or "main".
std::string to_text(const Place& place);

}  // namespace capsoc::source
