// The instruction trace: one line for each instruction and each exception.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>

#include "armv7m/core.h"
#include "trace/functions.h"
#include "trace/line_file.h"

namespace capsoc::trace {

/// Lines of cycle, simulated seconds, PC, place, disassembly and the registers that the instruction
/// changed, with their new values. Times are those at which an instruction begins.
class InstructionTrace {
 public:
  InstructionTrace(std::unique_ptr<LineFile> file, Functions& functions);

  void issued(const armv7m::Core& core, const armv7m::DecodedOp& op);
  /// An instruction was issued and has not retired.
  bool pending() const { return pending_; }
  /// `seconds`: when it was issued.
  void retired(const armv7m::Core& core, const armv7m::DecodedOp& op, double seconds);
  void entered(unsigned exception, armv7m::Entry how, uint64_t since, double seconds);
  void returned(const armv7m::Core& core, unsigned exception, double seconds);
  void started(const armv7m::Core& core, double seconds);
  /// Cycle at which the instruction under way began.
  uint64_t issue_cycle() const { return issue_cycle_; }

  std::optional<Error> finish(const armv7m::Core& core, double seconds);

 private:
  static constexpr unsigned fpu_registers = armv7m::Fpu::registers + 1;  // and FPSCR
  static constexpr unsigned register_count = 20 + fpu_registers;
  using Registers = std::array<uint32_t, register_count>;

  static Registers registers_of(const armv7m::Core& core);
  std::string changes(const Registers& now) const;
  const std::string& text_of(const armv7m::DecodedOp& op);

  struct Text {
    uint32_t encoding;
    uint8_t it_state;
    std::string text;  ///< PC, place and disassembly
  };

  std::unique_ptr<LineFile> file_;
  Functions& functions_;
  std::unordered_map<uint32_t, Text> texts_;
  Registers before_{};
  uint64_t issue_cycle_ = 0;
  bool pending_ = false;
};

}  // namespace capsoc::trace
