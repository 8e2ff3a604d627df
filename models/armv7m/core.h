#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "armv7m/executors/blocks.h"
#include "armv7m/executors/stepping.h"
#include "armv7m/executors/translator/translator.h"
#include "armv7m/known_turn.h"
#include "armv7m/machine.h"
#include "armv7m/observers.h"
#include "armv7m/profile.h"

namespace capsoc::armv7m {

enum class StopReason {
  budget,
  sleeping,
  lockup,
  semihosting_exit,
  semihosting_waits,  ///< the call under way has no answer yet; the next run() asks for it again
  breakpoint,
  watchpoint,
  reset_request,
  attention,
  stuck
};
enum class Executor { stepping, blocks, translator };

/// A core of the M-profile with 32 interrupts, the Cortex-M3 by default (ARM DDI 0403; profile.h
/// has the cores that there are). The executors agree bit for bit and cycle for cycle.
/// Nothing a guest does ends the host program.
class Core {
 public:
  static constexpr unsigned interrupt_count = exception::interrupts;
  static constexpr uint64_t never = State::never;

  /// Neither is owned.
  explicit Core(Bus& bus, const Profile& profile = cortex_m3)
      : machine_(*this, bus, profile), stepping_(machine_), blocks_(machine_, stepping_) {}

  // Construction parameters. Set before reset().
  /// Where reset() finds the vector table, and VTOR's reset value (B3.2.5): 0 unless set.
  void set_vector_table(uint32_t address) { vector_table_ = address; }
  /// Implemented bits of each priority (B1.5.4) from the most significant one down, the profile's
  /// least unless set; numbers that the profile does not allow count as the nearest of those.
  void set_priority_bits(unsigned bits) {
    const Profile& of = profile();
    machine_.state.nvic.set_priority_bits(
        std::clamp(bits, of.least_priority_bits, of.most_priority_bits));
  }
  unsigned priority_bits() const {
    return static_cast<unsigned>(__builtin_popcount(machine_.state.nvic.priority_mask()));
  }

  /// Power-on reset: reads the vector table; cycles continue, so that time does not jump.
  void reset();

  const Profile& profile() const { return machine_.profile; }

  // Memory
  /// Memory the core reaches without the bus; `wait_states` a word. The host memory is not owned.
  /// After writing to it from outside the core call invalidate_code().
  void map_memory(uint32_t base, uint32_t size, uint8_t* host, bool writable,
                  unsigned wait_states) {
    machine_.memory.map().map({base, size, host, writable, wait_states});
  }
  void unmap_memory(uint32_t base, uint32_t size) { machine_.memory.map().unmap(base, size); }
  void invalidate_code(uint32_t address, uint32_t size) {
    machine_.memory.invalidate_code(address, size);
  }
  /// Drops all decoded code. Call after writing guest memory from outside the core.
  void memory_changed() { machine_.memory.invalidate_all_code(); }
  /// Access without side effects or time, for debuggers; false if the memory is not accessible.
  bool debug_read(uint32_t address, void* data, uint32_t size) const {
    return machine_.memory.debug_read(address, data, size);
  }
  bool debug_write(uint32_t address, const void* data, uint32_t size) {
    return machine_.memory.debug_write(address, data, size);
  }

  // Time
  /// Executes whole instructions while cycles() < until_cycle.
  StopReason run(uint64_t until_cycle);
  /// One instruction (or the entry of one exception).
  StopReason step_instruction();
  /// Executes one iteration of the program's present loop, by single steps, while cycles() is below
  /// `until_cycle` and attention() is not requested. If the first iteration leaves other registers
  /// or flags, it executes a second one. Empty: the program does not return soon, or with other
  /// registers or flags, or the iteration does more than compute and load. The executed
  /// instructions count as in run(). The caller must check the effects of the loads from the bus.
  std::optional<Turn> repeat_turn(uint64_t until_cycle);
  /// The iteration that repeat_turn() found last, if it would find the same now. Assumes that its
  /// one load gives the same value in the same time. Executes nothing.
  std::optional<Turn> known_turn() const;
  /// Skips all whole iterations that end before or at `until_cycle`, each like `turn`.
  void skip_turns(const Turn& turn, uint64_t until_cycle);
  /// Cycles since construction; inside a bus access the cycle at which it happens.
  uint64_t cycles() const { return machine_.cycles(); }
  uint64_t instructions() const { return machine_.state.instructions; }
  /// Advances a sleeping core to `cycle`; SysTick counts.
  void skip_to(uint64_t cycle);
  /// Cycle of SysTick's next wrap that pends its exception, else `never`.
  uint64_t next_internal_event() const { return machine_.state.systick.event(); }
  /// HCLK cycles of SysTick's reference clock (25 at reset).
  void set_systick_reference(unsigned cycles_a_tick) {
    machine_.state.systick.set_reference(cycles(), cycles_a_tick);
  }
  /// Before set_executor().
  void limit_translator(const TranslatorLimits& limits) { translator_limits_ = limits; }
  /// Without a translator on this host, `blocks` is used instead: see no_translator().
  void set_executor(Executor executor);
  /// Why a requested translator is not available; empty: it is, or none was requested.
  const std::string& no_translator() const {
    return translator_ != nullptr ? translator_->refusal() : no_translator_;
  }
  /// How often a block is executed before it is translated, 1 to 254; after set_executor().
  void set_translation_threshold(uint8_t executions) {
    if (translator_ != nullptr) translator_->set_threshold(executions);
  }
  /// What the translator has done; none without one.
  std::optional<TranslationCounts> translation() const {
    if (translator_ == nullptr || !translator_->refusal().empty()) return std::nullopt;
    return translator_->counts();
  }

  // Wires
  void set_interrupt(unsigned line, bool level);
  void pulse_nmi() { machine_.pending.pend(exception::nmi); }
  void send_event();  // the RXEV input
  /// The answer to the semihosting call under way comes later: nothing more is executed, and every
  /// run() makes the call again until it is answered.
  void ask_again() {
    edit().semihosting_waits = true;
    machine_.requests.raise(Requests::unanswered);
  }
  bool waits_for_answer() const { return machine_.state.semihosting_waits; }
  /// Leaves run() after the present instruction.
  void attention() { machine_.requests.raise(Requests::attention); }
  bool sleeping() const { return machine_.state.sleeping; }
  bool locked_up() const { return machine_.state.locked_up; }
  bool wake_pending() const { return machine_.pending.wake_pending(); }

  // State, between two instructions
  const State& state() const { return machine_.state; }
  /// The state, to be changed, registers above all. The core then re-evaluates what depends on it.
  State& edit();
  /// r0-r12, 13 the stack pointer in use, 14 LR, 15 the address of the next instruction.
  uint32_t reg(unsigned n) const { return machine_.state.reg(n); }
  void set_reg(unsigned n, uint32_t value) { edit().set_reg(n, value); }
  /// Loading drops everything derived from the previous state. If memory was loaded too, call
  /// memory_changed().
  void visit(Archive& archive);
  const FaultReport& last_fault() const { return machine_.state.last_fault; }
  /// The fault that began the present chain: no other fault was being handled when it happened.
  const FaultReport& first_fault() const { return machine_.state.first_fault; }
  uint64_t fault_count() const { return machine_.state.fault_count; }

  // Observers
  Listeners& listeners() { return machine_.listeners; }
  /// Registers an observer, called after those already registered. Not owned. `instructions`:
  /// notified of each one; meanwhile the core steps. `accesses`: notified of each data access;
  /// meanwhile direct memory takes the slow path. Exceptions are always notified. An observer that
  /// was added before is added again.
  void add_observer(Observer& observer, bool instructions, bool accesses);
  void remove_observer(Observer& observer);
  Debugging& debugging() { return machine_.debugging; }
  /// Starts counting executions; call between two runs. Null stops counting. Not owned.
  void count_executions(ExecutionCounts* counts);

 private:
  StopReason execute(uint64_t until_cycle);
  std::optional<StopReason> service();
  std::optional<StopReason> stop_wanted();
  void expire_systick();
  std::optional<Turn> measure_turn(uint64_t until_cycle);
  bool turns_are_seen() const;
  void step_observed();
  bool is_interrupted() const;
  void observers_changed();

  Machine machine_;
  Stepping stepping_;
  Blocks blocks_;
  Observers observers_;
  uint32_t vector_table_ = 0;
  bool one_instruction_ = false;
  KnownTurn known_turn_;
  Executor executor_ = Executor::blocks;
  TranslatorLimits translator_limits_;
  std::unique_ptr<Translator> translator_;
  std::string no_translator_;
  InstructionExecutor* executing_ = &blocks_;  // stepping while each instruction is observed
};

}  // namespace capsoc::armv7m
