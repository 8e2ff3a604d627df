#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <vector>

#include "cortex_m3/bus.h"
#include "cortex_m3/memory.h"
#include "cortex_m3/observer.h"
#include "cortex_m3/state.h"
#include "cortex_m3/unpredictable.h"

namespace capsoc::cortex_m3 {

enum class StopReason {
  budget,
  sleeping,
  lockup,
  semihosting_exit,
  breakpoint,
  watchpoint,
  reset_request,
  attention,
  stuck
};
enum class Executor { stepping, blocks };

/// Data accesses that a debugger wants to see: loads and stores of instructions to a range.
struct Watchpoint {
  uint32_t address = 0, size = 0;
  bool on_read = false, on_write = false;

  bool operator==(const Watchpoint& other) const {
    return address == other.address && size == other.size && on_read == other.on_read &&
           on_write == other.on_write;
  }
};
/// The access that ended a run.
struct WatchHit {
  Watchpoint watchpoint;
  uint32_t address = 0;  ///< first watched byte that was touched
};

/// A program's write of priority bits that are not implemented (B1.5.4) and so are dropped.
struct DroppedPriority {
  uint32_t address = 0;   ///< of the NVIC's or SCB's word; 0: BASEPRI
  uint32_t value = 0;     ///< as written, at its place in the word
  bool all_ones = false;  ///< they all are: the program means any number of bits (0xFF, 191)
};

/// An ARMv7-M Cortex-M3 (ARM DDI 0403) with 32 interrupts of 8 to 256 priorities. Both executors
/// agree bit for bit and cycle for cycle. Nothing a guest does ends the host program.
class Core {
 public:
  static constexpr unsigned interrupt_count = 32;
  static constexpr uint64_t never = State::never;

  explicit Core(Bus& bus);
  /// Power-on reset: reads the vector table; cycles go on, so that time does not jump.
  void reset();
  /// Where reset() finds the vector table, and VTOR's reset value (B3.2.5): 0 unless set.
  void set_vector_table(uint32_t address) { vector_table_ = address; }

  /// Memory the core reaches without the bus; `wait_states` a word. The host memory stays the
  /// caller's. Whoever else writes into it calls invalidate_code().
  void map_memory(uint32_t base, uint32_t size, uint8_t* host, bool writable, unsigned wait_states);
  void unmap_memory(uint32_t base, uint32_t size);
  void invalidate_code(uint32_t address, uint32_t size);

  /// Executes whole instructions while cycles() < until_cycle.
  StopReason run(uint64_t until_cycle);
  /// One instruction (or the entry of one exception).
  StopReason step_instruction();
  /// Cycles since construction; inside a bus access the cycle at which it happens.
  uint64_t cycles() const { return state_.cycles + access_offset_; }
  uint64_t instructions() const { return state_.instructions; }
  /// While sleeping: time passes, SysTick counts.
  void skip_to(uint64_t cycle);
  /// Cycle of SysTick's next wrap that pends its exception, else `never`.
  uint64_t next_internal_event() const { return state_.systick.event; }

  void set_interrupt(unsigned line, bool level);
  void pulse_nmi();
  void send_event();  // the RXEV input
  /// Leaves run() after the present instruction.
  void attention();
  bool sleeping() const { return state_.sleeping; }
  bool locked_up() const { return state_.locked_up; }
  bool wake_pending() const;
  void set_executor(Executor executor);
  /// Who looks on; null: nobody. It stays the caller's. `instructions`: at each one, the executor
  /// is stepping meanwhile. `accesses`: at each data access, direct memory is reached the slow way
  /// meanwhile. Exceptions are told either way.
  void set_observer(Observer* observer, bool instructions, bool accesses);

  /// r0-r12, 13 the stack pointer in use, 14 LR, 15 the address of the next instruction.
  uint32_t reg(unsigned n) const { return n == 15 ? state_.pc : state_.r[n & 15]; }
  void set_reg(unsigned n, uint32_t value);
  uint32_t xpsr() const;
  void set_xpsr(uint32_t value);
  uint32_t msp() const { return uses_psp() ? state_.other_sp : state_.r[13]; }
  uint32_t psp() const { return uses_psp() ? state_.r[13] : state_.other_sp; }
  void set_msp(uint32_t value);
  void set_psp(uint32_t value);
  uint32_t control() const { return state_.control; }
  uint32_t primask() const { return state_.primask; }
  uint32_t faultmask() const { return state_.faultmask; }
  uint32_t basepri() const { return state_.basepri; }
  void set_control(uint32_t value);
  void set_primask(bool masked);
  void set_basepri(uint32_t value);
  void set_faultmask(bool masked);

  /// Access without side effects or time, for debuggers; false where nothing can be shown.
  bool debug_read(uint32_t address, void* data, uint32_t size) const;
  bool debug_write(uint32_t address, const void* data, uint32_t size);

  /// Called on BKPT 0xAB with PC behind it; false ends run() with semihosting_exit.
  void set_semihosting(std::function<bool(Core&)> handler) { semihosting_ = std::move(handler); }
  /// Called for what the program writes to a stimulus port of the ITM: `size` bytes of `value`.
  using Stimulus = std::function<void(unsigned port, uint32_t value, unsigned size)>;
  void set_stimulus(Stimulus listener) { stimulus_ = std::move(listener); }
  /// Implemented bits of each priority (B1.5.4), 3 to 8 from the most significant one down; others
  /// count as the nearest of these. Before reset().
  void set_priority_bits(unsigned bits);
  /// Called the first time a program writes priority bits that are not implemented, and the first
  /// time it writes nothing but ones there. Meanwhile reg(15) is the instruction's address.
  using PriorityListener = std::function<void(const DroppedPriority&)>;
  void set_priority_listener(PriorityListener l) { priority_listener_ = std::move(l); }
  /// Called the first time a program runs into each UNPREDICTABLE case (unpredictable.def), with
  /// the address of the instruction, which reg(15) is meanwhile.
  using UnpredictableListener = std::function<void(Unpredictable which, uint32_t address)>;
  void set_unpredictable_listener(UnpredictableListener l) {
    unpredictable_listener_ = std::move(l);
  }
  /// Ends run() before the instruction at the address; the next run() executes it.
  void set_breakpoint(uint32_t address);
  void clear_breakpoint(uint32_t address) { breakpoints_.erase(address & ~1u); }
  bool has_breakpoint(uint32_t address) const { return breakpoints_.count(address & ~1u) != 0; }
  /// The next run() executes the instruction at PC whether it has a breakpoint or not.
  void pass_breakpoint();
  /// Ends run() behind the instruction that made such an access.
  void set_watchpoint(const Watchpoint& watchpoint);
  void clear_watchpoint(const Watchpoint& watchpoint);
  const WatchHit& watch_hit() const { return watch_hit_; }
  /// As with halting debug (C1.6): BKPT ends run() with breakpoint before it is executed, instead
  /// of raising a fault.
  void set_halting_debug(bool enabled) { halting_debug_ = enabled; }
  /// Ends run() with `stuck` behind a branch to itself in HardFault, MemManage, BusFault or
  /// UsageFault (the default handlers of CMSIS) that no enabled exception can preempt, if
  /// `hopeless` says that nothing outside can, either (NMI, reset). Empty: never.
  void set_stop_in_fault(std::function<bool()> hopeless) { hopeless_ = std::move(hopeless); }
  /// HCLK cycles of SysTick's reference clock (25 at reset).
  void set_systick_reference(unsigned cycles_a_tick);

  /// The state, between two instructions. After loading, whatever was made from another state is
  /// dropped; memory_changed() says that memory was loaded, too.
  void visit(kit::Archive& archive);
  /// Whoever else wrote into memory, anywhere: decoded code is dropped.
  void memory_changed();

  const FaultReport& last_fault() const { return state_.last_fault; }
  /// The fault that began the present chain: no other fault was being handled when it happened.
  const FaultReport& first_fault() const { return state_.first_fault; }
  uint64_t fault_count() const { return state_.fault_count; }

 private:
  friend struct Execute;
  enum class Access : uint8_t { ok, leave, fault };
  enum class Event : uint8_t { none, fault, svc, bkpt, exception_return };
  enum class Cause : uint8_t {
    undefined_instruction,
    invalid_state,
    invalid_pc,
    no_coprocessor,
    unaligned,
    divide_by_zero,
    fetch_bus,
    fetch_access,
    data_bus,
    data_access,
    stacking_bus,
    stacking_access,
    unstacking_bus,
    unstacking_access
  };

  // core.cpp
  bool uses_psp() const { return state_.ipsr == 0 && (state_.control & 2) != 0; }
  bool privileged() const { return state_.ipsr != 0 || (state_.control & 1) == 0; }
  void select_stack(bool psp);
  void branch_write_pc(uint32_t address) { state_.pc = address & ~1u; }
  bool bx_write_pc(uint32_t target);
  bool condition_passed(unsigned condition) const;
  // blocks.cpp
  bool leave(const Step& op) {
    state_.pc = next_address(op);
    return false;
  }
  bool fault(const Step& op, Cause cause, uint32_t address = 0);
  void step();
  bool fetch(uint32_t address, uint16_t& halfword);
  void execute_block(uint64_t limit);
  const Step* find_block();
  static void add_cycles(Step& step, uint16_t before, uint32_t wait_states);
  std::unique_ptr<Step[]> build_block(uint32_t address, CodePage& page);
  CodePage* executable_page(uint32_t address);
  const Step* leave_block(const Step& op);
  const Step* resolve_link(const Step& branch);
  const Step* next_block();
  // core.cpp
  void account(const Step& op);
  void conclude(const Step& op);
  void finish(const Step& op);
  void handle_event();
  std::optional<StopReason> service();
  void execute_without_thumb();
  void sleep_until_wake(bool for_event);

  // access.cpp
  template <typename T>
  Access load(const Step& op, uint32_t address, uint32_t& value);
  template <typename T>
  Access store(const Step& op, uint32_t address, uint32_t value);
  Access load_slow(const Step& op, uint32_t address, unsigned size, uint32_t& value,
                   bool user = false);
  Access store_slow(const Step& op, uint32_t address, unsigned size, uint32_t value,
                    bool user = false);
  enum class Result : uint8_t { ok, device, bus_error, violation };
  Result read_aligned(uint32_t address, unsigned size, uint32_t& value, bool priv);
  Result write_aligned(uint32_t address, unsigned size, uint32_t value, bool priv);
  Result read_physical(uint32_t address, unsigned size, uint32_t& value);
  Result write_physical(uint32_t address, unsigned size, uint32_t value);
  Result observe(const DirectAccess& access, Result result) const;

  // exceptions.cpp
  int group_priority(int priority) const;
  int exception_priority(unsigned number) const;
  int raw_execution_priority() const;
  int execution_priority(bool ignore_primask = false) const;
  unsigned highest_pending(int below) const;
  bool exception_enabled(unsigned number) const;
  void pend(unsigned number);
  void raise(unsigned number, uint32_t return_address);
  void exception_entry(unsigned number, uint32_t return_address);
  bool push_stack(uint32_t return_address, Cause& cause);
  void late_arrival(unsigned number);
  void exception_taken(unsigned number, uint32_t exc_return, Entry how, uint64_t since);
  void exception_return(uint32_t exc_return);
  void return_fault(Cause cause, uint32_t exc_return);
  bool pop_stack(uint32_t exc_return, Cause& cause);
  unsigned derived_exception(Cause cause);
  unsigned escalate(unsigned number, int priority);
  void deactivate(unsigned number);
  unsigned record_cause(Cause cause, uint32_t address);
  void capture_fault(unsigned number, uint32_t return_address);
  void lock_up();
  void imprecise_bus_fault();
  void debug_event(uint32_t dfsr_bit);
  bool monitor_can_preempt() const;
  bool monitor_enabled() const;
  void breakpoint_instruction(uint32_t address);
  bool in_fault_handler() const { return state_.ipsr >= 3 && state_.ipsr <= 6; }
  bool can_be_preempted() const;
  void spin_in_fault();
  unsigned active_count() const;

  // system_control.cpp
  Result ppb_read(uint32_t address, unsigned size, uint32_t& value, bool priv);
  Result ppb_write(uint32_t address, unsigned size, uint32_t value, bool priv);
  uint32_t ppb_read_word(uint32_t address, bool debug) const;
  uint32_t ppb_peek(uint32_t address) const { return ppb_read_word(address, true); }
  void ppb_write_word(uint32_t address, uint32_t value, uint32_t mask);
  void write_nvic(uint32_t address, uint32_t value, uint32_t mask);
  void write_shcsr(uint32_t value);
  void write_mpu(uint32_t address, uint32_t value);
  uint32_t icsr() const;
  void reset_system_control();
  void reevaluate() { check_ = true; }

  // systick
  uint64_t systick_tick(uint64_t cycle) const;
  uint32_t systick_value(uint64_t cycle, bool& wrapped) const;
  void systick_sync();
  void systick_schedule();
  void systick_expire();

  // itm.cpp
  static bool in_itm(uint32_t address);
  bool stimulus_enabled(unsigned port) const;
  bool itm_open_to_user(uint32_t address) const;
  uint32_t itm_read(uint32_t address) const;
  void itm_write(uint32_t address, unsigned size, uint32_t value);

  // mpu.cpp
  int mpu_region(uint32_t address) const;
  bool mpu_allows(uint32_t address, bool write, bool fetch, bool priv);
  uint32_t mpu_rights(uint32_t address) const;
  uint8_t* shared_page(uint32_t address, bool write, bool user);
  void mpu_changed();
  bool mpu_applies() const;
  bool mpu_uniform_in_page(uint32_t address) const;
  void select_view();
  void fill_view(uint32_t address);

  // dwt.cpp
  static bool in_dwt_comparators(uint32_t address);
  uint32_t dwt_read(uint32_t address) const;
  void dwt_write(uint32_t address, uint32_t value, uint32_t mask);
  void write_demcr(uint32_t value);
  void select_dwt();
  uint32_t cycle_count() const;
  void step_observed();
  void match_data(uint32_t address, unsigned size, bool write);
  void match_step(uint32_t executed);
  bool dwt_watches_page(uint32_t page) const;

  // unpredictable cases
  void unpredictable(Unpredictable which, uint32_t address);
  void check_system_access(const Step& op, uint32_t address, unsigned size);
  void check_system_write(const Step& op, uint32_t address, uint32_t value);
  void check_priorities(const Step& op, uint32_t address, unsigned size, uint32_t value);
  void check_basepri(const Step& op, uint32_t value);
  void dropped_priority(const Step& op, const DroppedPriority& dropped);
  void check_mpu_region(const Step& op, unsigned number);
  void check_unaligned(const Step& op, uint32_t address, unsigned size);
  bool buffered(const Step& op, uint32_t address) const;
  Access failed_access(const Step& op, Result result, uint32_t address);

  // watchpoints.cpp
  bool watches_data() const { return !watchpoints_.empty() || state_.dwt.watches_data; }
  bool watches_page(uint32_t address) const;
  bool watched(uint32_t address, unsigned size, bool write);
  bool at_breakpoint();

  State state_;
  // Between two instructions none of what follows is more than a cache, a wire or a debugger's.
  bool check_ = false;  // something besides the next instruction needs looking at
  Event event_ = Event::none;
  uint64_t access_offset_ = 0;
  uint64_t limit_ = 0;  // blocks that may reach this cycle are not entered by a link
  Memory::Page* fast_pages_ = nullptr;
  bool attention_ = false, invalidated_ = false;
  Cause event_cause_{};
  uint32_t event_value_ = 0;
  uint32_t event_return_ = 0;

  Bus& bus_;
  Memory memory_;
  uint32_t priority_mask_ = 0xE0;  // the bits that are implemented
  uint32_t vector_table_ = 0;
  struct MpuLine {
    uint32_t tag, rights;  // of 32 bytes; tag 0: none
  };
  std::array<MpuLine, 64> mpu_lines_{};

  Executor executor_ = Executor::blocks;
  bool in_blocks_ = true;  // executor_ is blocks and nobody looks on at instructions
  Observer* observer_ = nullptr;
  bool sees_instructions_ = false, sees_accesses_ = false;
  std::function<bool(Core&)> semihosting_;
  Stimulus stimulus_;
  PriorityListener priority_listener_;
  UnpredictableListener unpredictable_listener_;
  std::function<bool()> hopeless_;
  bool stuck_ = false;
  std::set<uint32_t> breakpoints_;
  uint64_t breakpoint_passed_ = never;  // instructions() when the one at passed_pc_ was passed
  uint32_t passed_pc_ = 0;
  std::vector<Watchpoint> watchpoints_;
  WatchHit watch_hit_;
  bool watch_stop_ = false, bkpt_stop_ = false, halting_debug_ = false;
};

inline bool Core::condition_passed(unsigned condition) const {
  bool n = (state_.n >> 31) != 0, z = state_.z == 0, result = false;
  switch (condition >> 1) {
    case 0:
      result = z;
      break;
    case 1:
      result = state_.c;
      break;
    case 2:
      result = n;
      break;
    case 3:
      result = state_.v;
      break;
    case 4:
      result = state_.c && !z;
      break;
    case 5:
      result = n == state_.v;
      break;
    case 6:
      result = n == state_.v && !z;
      break;
    default:
      return true;
  }
  return result != ((condition & 1) != 0);
}

template <typename T>
inline Core::Access Core::load(const Step& op, uint32_t address, uint32_t& value) {
  const Memory::Page& p = fast_pages_[address >> Memory::page_bits];
  if (__builtin_expect(p.read != nullptr && (address & (sizeof(T) - 1)) == 0, 1)) {
    T data;
    std::memcpy(&data, p.read + (address & (Memory::page_size - 1)), sizeof(T));
    value = data;
    if (__builtin_expect(p.wait_states != 0, 0)) state_.cycles += p.wait_states;
    return Access::ok;
  }
  return load_slow(op, address, sizeof(T), value);
}

template <typename T>
inline Core::Access Core::store(const Step& op, uint32_t address, uint32_t value) {
  const Memory::Page& p = fast_pages_[address >> Memory::page_bits];
  if (__builtin_expect(p.write != nullptr && (address & (sizeof(T) - 1)) == 0, 1)) {
    T data = static_cast<T>(value);
    std::memcpy(p.write + (address & (Memory::page_size - 1)), &data, sizeof(T));
    if (__builtin_expect(p.wait_states != 0, 0)) state_.cycles += p.wait_states;
    return Access::ok;
  }
  return store_slow(op, address, sizeof(T), value);
}

}  // namespace capsoc::cortex_m3
