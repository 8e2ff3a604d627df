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
  bool all_ones = false;  ///< all are 1: the program works with any number of bits (0xFF, 191)
};

/// A block that was translated.
struct Translation {
  uint32_t address = 0;               ///< of its first instruction
  const void* code = nullptr;         ///< of the host, `bytes` long
  std::size_t offset = 0, bytes = 0;  ///< in the buffer for code
  uint64_t evictions = 0;  ///< so far; translations from before the last eviction are gone
  std::string listing;     ///< each instruction with its host code below it
};

/// A program's write to memory in its vector table, done already.
struct VectorWrite {
  uint32_t address = 0, value = 0;
  unsigned size = 0;  ///< 1, 2 or 4 bytes
};

/// Callbacks for guest events. Unset callbacks are ignored.
struct Listeners {
  /// BKPT 0xAB, with PC after it; false ends run() with semihosting_exit. One that has no answer
  /// yet calls Core::ask_again().
  std::function<bool(Core&)> semihosting;
  /// The program writes to a stimulus port of the ITM: `size` bytes of `value`.
  std::function<void(unsigned port, uint32_t value, unsigned size)> stimulus;
  /// The first time a program writes priority bits that are not implemented, and the first time it
  /// writes nothing but ones there. Meanwhile reg(15) is the instruction's address.
  std::function<void(const DroppedPriority&)> priority;
  /// The first time a program runs into each UNPREDICTABLE case (unpredictable.def), with the
  /// address of the instruction, which reg(15) is meanwhile.
  std::function<void(Unpredictable which, uint32_t address)> unpredictable;
  /// The program writes into its vector table (VTOR); reg(15) is the instruction's address.
  /// Returning false unsets the callback. Set it before reset(), and again before a state is
  /// loaded.
  std::function<bool(const VectorWrite&)> vectors;
  /// Called when a program spins in HardFault, MemManage, BusFault or UsageFault (`b .`, the
  /// default handlers of CMSIS) and no enabled exception can preempt. True: no NMI and no reset can
  /// come either, and run() ends with `stuck`. Unset: it never does.
  std::function<bool()> hopeless;

  /// An exception other than a fault becomes pending.
  std::function<void(unsigned exception)> pended;
  /// WFI or WFE puts the processor to sleep (true), or it wakes (false), before the exception or
  /// the next instruction.
  std::function<void(bool is_asleep)> sleeps;
  /// Called once, if the translator gets no memory for its code: the core continues with blocks.
  std::function<void(const std::string& reason)> untranslated;
  /// A block was translated. Setting it costs a listing for each block.
  std::function<void(const Translation&)> translated;

  /// Set by Core::add_observer.
  Observer* observer = nullptr;
  bool sees_instructions = false, sees_accesses = false;
};

}  // namespace capsoc::armv7m
