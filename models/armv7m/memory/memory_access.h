#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <optional>

#include "armv7m/core_context.h"
#include "armv7m/executors/step.h"
#include "armv7m/memory/bus.h"
#include "armv7m/memory/memory.h"
#include "armv7m/memory/private_bus.h"
#include "armv7m/pending_exceptions.h"
#include "armv7m/watchpoints.h"

namespace capsoc::armv7m {

/// Outcome of an access for its instruction: continue, leave the block after the instruction, or
/// fault: the fault is recorded and the instruction has no effect.
enum class Access : uint8_t { ok, leave, fault };
/// The processor's way to memory: direct pages, the MPU, bit-band aliases, the private peripheral
/// bus and the bus (B2, B3.1).
class MemoryAccess {
 public:
  /// Nothing is owned.
  MemoryAccess(CoreContext& context, Bus& bus, PrivateBus& private_bus, PendingExceptions& pending,
               Watchpoints& watchpoints)
      : context_(context),
        bus_(bus),
        private_bus_(private_bus),
        pending_(pending),
        watchpoints_(watchpoints) {}

  // For instructions. `user`: as without privilege (LDRT, STRT).
  template <typename T>
  Access load(const Step& op, uint32_t address, uint32_t& value);
  template <typename T>
  Access store(const Step& op, uint32_t address, uint32_t value);
  Access load_slow(const Step& op, uint32_t address, unsigned size, uint32_t& value,
                   bool user = false);
  Access store_slow(const Step& op, uint32_t address, unsigned size, uint32_t value,
                    bool user = false);
  /// An aligned access of an instruction to a device that answers at once. False, and nothing is
  /// done: it takes load_slow() or store_slow(). After it the block is left.
  struct AtOnce {
    uint32_t instruction;    ///< its address
    uint32_t cycles_before;  ///< of its block
    uint32_t address, size;
  };
  bool load_at_once(const AtOnce& access, uint32_t& value);
  bool store_at_once(const AtOnce& access, uint32_t value);
  /// True where the default map (B3.1) has devices on the bus, and nothing but devices.
  static bool is_device(uint32_t address);
  /// Fetches a halfword of code; returns the cause of the fault if that fails.
  std::optional<Cause> fetch(uint32_t address, uint16_t& halfword);

  // For the exception model: aligned accesses, and accesses that bypass the MPU and the system
  // registers.
  BusResult read(uint32_t address, unsigned size, uint32_t& value, bool privileged);
  BusResult write(uint32_t address, unsigned size, uint32_t value, bool privileged);
  /// The same at another priority than the present one (State::at_negative_priority).
  BusResult write(uint32_t address, unsigned size, uint32_t value, bool privileged,
                  bool at_negative_priority);
  BusResult read_physical(uint32_t address, unsigned size, uint32_t& value);
  /// Host bytes of at most 16 words that may all be accessed directly; their wait states are
  /// charged. Null: access them one by one, by read() and write().
  uint8_t* plain(uint32_t address, unsigned words, bool write);

  // For the executors.
  Memory& map() { return memory_; }
  const Memory& map() const { return memory_; }
  const Memory::Page& direct(uint32_t address) const {
    return pages_[address >> Memory::page_bits];
  }
  /// The table of direct pages in use.
  const Memory::Page* pages() const { return pages_; }
  /// All memory can be reached directly: no MPU, no watchpoint and no observer applies.
  bool is_whole_view() const { return pages_ == memory_.table(); }
  /// True if an observer wants accesses that host code would make, or omit, unobserved.
  bool is_watched() const;
  /// The record of a page that is executable as a whole, created on demand; null for other pages.
  CodePage* executable_page(uint32_t address);

  // Depends on the mode, the MPU, watchpoints and observers.
  /// The table of direct pages for the present privilege and MPU.
  void select_view();
  /// Call after the MPU's registers, or all of the state, have changed.
  void regions_changed();
  /// Call after another change that decides which pages are direct.
  void views_changed();

  // Decoded code.
  void invalidate_code(uint32_t address, uint32_t size);
  void invalidate_all_code();
  /// Between two blocks: frees what was invalidated.
  void collect();
  /// Lets stores into the vector table take the slow path, if a listener is notified of them.
  void watch_vectors();

  /// Access without side effects or time, for debuggers; false where nothing can be shown.
  bool debug_read(uint32_t address, void* data, uint32_t size) const;
  bool debug_write(uint32_t address, const void* data, uint32_t size);

 private:
  bool in_bit_band_alias(uint32_t address) const;
  bool is_memory_behind_bus(uint32_t address) const;
  BusResult write_physical(uint32_t address, unsigned size, uint32_t value);
  BusResult observe(const DirectAccess& access, BusResult result) const;
  /// observe(), if there is an observer.
  BusResult shown(const DirectAccess& access, BusResult result) const;
  /// In the vector table.
  bool is_vector(uint32_t address) const;
  void tell_of_vector(const VectorWrite& write);
  bool mpu_applies() const;
  bool allows(uint32_t address, bool write, bool fetch, bool privileged) {
    return !mpu_applies() || regions_allow(address, write, fetch, privileged);
  }
  bool regions_allow(uint32_t address, bool write, bool fetch, bool privileged);
  uint8_t* shared_page(uint32_t address, bool write, bool user);
  bool may_be_at_once(uint32_t address, bool write);
  void fill_view(uint32_t address);
  bool buffered(const Step& op, uint32_t address) const;
  bool must_be_aligned(uint32_t address) const;
  void check_unaligned(const Step& op, uint32_t address, unsigned size);
  Access failed(const Step& op, BusResult result, uint32_t address);
  Access concluded(const Step& op, uint32_t address, unsigned size, bool write, bool user,
                   BusResult worst, uint32_t failed_at);
  void add_cycles(uint64_t cycles);

  CoreContext& context_;
  Bus& bus_;
  PrivateBus& private_bus_;
  PendingExceptions& pending_;
  Watchpoints& watchpoints_;
  Memory memory_;
  Memory::Page* pages_ = nullptr;  // the view in use
  bool code_dropped_ = false;
  struct Line {
    uint32_t tag, rights;  // of 32 bytes; tag 0: none
  };
  std::array<Line, 64> lines_{};  // what the MPU decided last
};

template <typename T>
inline Access MemoryAccess::load(const Step& op, uint32_t address, uint32_t& value) {
  const Memory::Page& p = direct(address);
  if (__builtin_expect(p.read != nullptr && (address & (sizeof(T) - 1)) == 0, 1)) {
    T data;
    std::memcpy(&data, p.read + (address & (Memory::page_size - 1)), sizeof(T));
    value = data;
    if (__builtin_expect(p.wait_states != 0, 0)) context_.state.cycles += p.wait_states;
    return Access::ok;
  }
  return load_slow(op, address, sizeof(T), value);
}

template <typename T>
inline Access MemoryAccess::store(const Step& op, uint32_t address, uint32_t value) {
  const Memory::Page& p = direct(address);
  if (__builtin_expect(p.write != nullptr && (address & (sizeof(T) - 1)) == 0, 1)) {
    T data = static_cast<T>(value);
    std::memcpy(p.write + (address & (Memory::page_size - 1)), &data, sizeof(T));
    if (__builtin_expect(p.wait_states != 0, 0)) context_.state.cycles += p.wait_states;
    return Access::ok;
  }
  return store_slow(op, address, sizeof(T), value);
}

}  // namespace capsoc::armv7m
