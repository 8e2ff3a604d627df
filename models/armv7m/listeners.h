#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "armv7m/isa/unpredictable.h"
#include "armv7m/observer.h"

namespace capsoc::armv7m {

/// A program's write of priority bits that are not implemented (B1.5.4) and so are dropped.
struct DroppedPriority {
  uint32_t address = 0;   ///< of the NVIC's or SCB's word; 0: BASEPRI
  uint32_t value = 0;     ///< as written, at its place in the word
  bool all_ones = false;  ///< they all are: the program means any number of bits (0xFF, 191)
};

/// A block that was translated.
struct Translation {
  uint32_t address = 0;               ///< of its first instruction
  const void* code = nullptr;         ///< of the host, `bytes` long
  std::size_t offset = 0, bytes = 0;  ///< in the buffer for code
  uint64_t evictions = 0;             ///< so far; what was translated before the last one is gone
  std::string listing;                ///< each instruction with its host code below it
};

/// A program's write to memory in its vector table, done already.
struct VectorWrite {
  uint32_t address = 0, value = 0;
  unsigned size = 0;  ///< 1, 2 or 4 bytes
};

/// Callbacks for guest events. Unset callbacks are ignored.
struct Listeners {
  /// BKPT 0xAB, with PC after it; false ends run() with semihosting_exit.
  std::function<bool(Core&)> semihosting;
  /// What the program writes to a stimulus port of the ITM: `size` bytes of `value`.
  std::function<void(unsigned port, uint32_t value, unsigned size)> stimulus;
  /// The first time a program writes priority bits that are not implemented, and the first time it
  /// writes nothing but ones there. Meanwhile reg(15) is the instruction's address.
  std::function<void(const DroppedPriority&)> priority;
  /// The first time a program runs into each UNPREDICTABLE case (unpredictable.def), with the
  /// address of the instruction, which reg(15) is meanwhile.
  std::function<void(Unpredictable which, uint32_t address)> unpredictable;
  /// Writes of a program into its vector table (VTOR), while reg(15) is the instruction's address;
  /// false: no more of them are to be told, which unsets it. To be set before reset() or, again,
  /// before a state is loaded.
  std::function<bool(const VectorWrite&)> vectors;
  /// Asked when a program spins in HardFault, MemManage, BusFault or UsageFault (`b .`, the default
  /// handlers of CMSIS) and no enabled exception can preempt: true if nothing outside can, either
  /// (NMI, reset). Then run() ends with `stuck`. Empty: it never does.
  std::function<bool()> hopeless;

  /// Each time that an exception becomes pending which was not, but for faults.
  std::function<void(unsigned exception)> pended;
  /// WFI or WFE puts the processor to sleep (true), and it wakes, in front of the exception or the
  /// instruction that continues.
  std::function<void(bool is_asleep)> sleeps;
  /// Once, when the translator turns out to have no memory for its code: blocks continue without
  /// it.
  std::function<void(const std::string& reason)> untranslated;
  /// Each block that is translated. Costs a text of each.
  std::function<void(const Translation&)> translated;

  /// Set by Core::add_observer.
  Observer* observer = nullptr;
  bool sees_instructions = false, sees_accesses = false;
};

}  // namespace capsoc::armv7m
