#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "armv7m/executors/translator/flag_sources.h"
#include "armv7m/memory/memory.h"

namespace capsoc::armv7m {

class Machine;
struct Step;

/// A step that translated code leaves to its function in C++ without leaving itself.
struct CalledStep {
  bool (*one)(Machine&, const Step&) = nullptr;
  const Step* step = nullptr;
};

/// Memory that host code reaches with one comparison: pages in a row that are mapped directly.
struct MemoryWindow {
  uint64_t units[3] = {};  ///< its size in bytes, halfwords, words; 0: closed
  uint8_t* host = nullptr;
  uint64_t bias = 0;  ///< from an address of the guest to the host's
  uint32_t base = 0;
  bool fixed = false;        ///< the base stays as long as there is translated code
  uint32_t wait_states = 0;  ///< of its region, as long as there is translated code for it
};

/// Where the code of the addresses is that indirect branches led to last: one load instead of the
/// three, each waiting for the one before, through the page's record.
struct JumpCache {
  static constexpr unsigned size = 256;
  static constexpr uint64_t none = ~uint64_t{0};  ///< no address with bit 0 set

  std::array<uint64_t, size> target{};  ///< bit 0 set, by its bits 1 and up
  std::array<const void*, size> code{};
  uint32_t used = 1;

  void clear() {
    if (used != 0) target.fill(none);
    used = 0;
  }
};

/// What translated code uses in addition to the state, at a fixed distance from it.
struct HostContext {
  static constexpr unsigned windows = 8;

  /// Upper half: cycles left, below zero when the budget is over. Lower half: instructions so far.
  uint64_t budget = 0;
  const Memory::Page* pages = nullptr;  ///< the view in use
  uint64_t closed = 0;                  ///< all ones: no store next to code, its page may forbid it
  const void* leave = nullptr;          ///< the code that returns to C++
  const CalledStep* called = nullptr;   ///< by number
  uint32_t recipe = 0;                  ///< of the flags that a block left uncomputed; 0: none
  WordsAside aside{};
  uint64_t place = 0;  ///< kept for a moment by a return
  // 0 or 1
  uint32_t fp_open = 0;    ///< FloatingPoint::is_open(), which C++ alone changes
  uint32_t fp_host = 0;    ///< the host computes with the modes that programs begin with
  uint32_t fp_native = 0;  ///< and FPSCR is such that FloatingOperations may use it
  const FlagSources* recipes = nullptr;  ///< by number
  /// The cycles that the budget had left when the state's were counted last.
  int64_t left = 0;
  // An access to a device by an instruction (DeviceCalls): address, the instruction's, the access,
  // what is stored.
  uint64_t (*load_at_once)(Machine&, uint32_t, uint32_t, uint32_t) = nullptr;
  uint64_t (*store_at_once)(Machine&, uint32_t, uint32_t, uint32_t, uint32_t) = nullptr;
  JumpCache jumps;
  /// By region: for reading; for writing the longest row without code, and the one it begins with.
  std::array<MemoryWindow, windows> read, write, write_from_base;

  /// Begins to count instructions, with cycles left.
  void set_left(int64_t cycles) {
    left = cycles;
    budget = static_cast<uint64_t>(cycles) << 32;
  }
  /// Adds to the state what was taken from the budget.
  void count(State& state) {
    const auto rest = static_cast<int32_t>(budget >> 32);
    state.cycles += static_cast<uint64_t>(left - rest);
    state.instructions += static_cast<uint32_t>(budget);
    set_left(rest);
  }
};

/// Bytes between a state of `size` bytes and its HostContext. A host that renames memory (AMD's
/// Zen) takes accesses by one base register for the same if their distances have the same low ten
/// bits. A member of the context there made each use of a guest's register wait: bench_soft_float
/// was 14 % slower.
constexpr std::size_t host_context_gap(std::size_t size) {
  constexpr std::size_t period = 1024;
  constexpr std::size_t hot_state = 256, hot_context = 128;  // at the beginning of each
  constexpr std::size_t least = 8;                           // an array has elements
  const std::size_t place = (size + least) % period;
  if (place < hot_state) return least + hot_state - place;
  return place <= period - hot_context ? least : least + period + hot_state - place;
}

}  // namespace capsoc::armv7m
