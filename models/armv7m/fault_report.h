#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace capsoc {
class Archive;
}

namespace capsoc::armv7m {

/// A buffered store that the bus refused (B1.5.14), which IMPRECISERR reports. The processor keeps
/// neither its address nor its value; the model does.
struct LostWrite {
  bool known = false;
  uint32_t address = 0, value = 0;
  uint32_t instruction = 0;  ///< address of the store
  uint64_t cycle = 0;

  void visit(Archive& archive);
};

/// Registers of the interrupted code.
struct InterruptedRegisters {
  std::array<uint32_t, 16> r{};  ///< 13: the stack pointer in use, 15: the return address
  uint32_t msp = 0, psp = 0;
  uint32_t ipsr = 0;  ///< the exception that it belonged to, 0: Thread mode

  void visit(Archive& archive);
};

/// State at the entry of a fault handler, or at lockup.
struct FaultReport {
  enum class Kind : uint8_t { none, hard_fault, mem_manage, bus_fault, usage_fault, lockup };
  Kind kind = Kind::none;
  unsigned exception = 0;  // number of the exception entered; at lockup the one running
  uint32_t cfsr = 0, hfsr = 0, mmfar = 0, bfar = 0;
  std::array<uint32_t, 8> frame{};  // r0-r3, r12, lr, pc, xpsr as stacked
  uint32_t address = 0;             // the faulting data address if valid, else the pc
  unsigned nesting = 0;             // exceptions active before this one
  uint64_t cycle = 0;
  InterruptedRegisters registers;  // before anything was stacked
  LostWrite lost_write;            // of an imprecise fault

  void visit(Archive& archive);
};

/// The fault status registers in words, one clause a bit; "no fault" when none is set.
std::string describe_cfsr(uint32_t cfsr, uint32_t hfsr);

}  // namespace capsoc::armv7m
