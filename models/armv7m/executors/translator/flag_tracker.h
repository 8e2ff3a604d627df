#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "armv7m/executors/translator/block_plan.h"
#include "armv7m/executors/translator/flag_sources.h"
#include "armv7m/executors/translator/host_code.h"
#include "armv7m/executors/translator/register_map.h"
#include "armv7m/isa/flag_liveness.h"

namespace capsoc::armv7m {

class Machine;

/// Where the guest's flags are at the point of the code that is being written, and the code that
/// computes them. Flags are not computed where they are set but where they are needed: a comparison
/// becomes code at its branch, or at an exit where the flags are live. For flags that an exit
/// leaves uncomputed there is a recipe, from which C++ computes them.
///
/// The step's code announces what it sets (set_sources, in_host); the compiler calls begin_step()
/// in front of it and end_step() after it. Sets of flags are those of flag::Bit.
class FlagTracker {
 public:
  /// Which flags of an operation the host's flags hold. shift: N, Z and C.
  enum class HostFlags : uint8_t { nz, shift, sum, difference };
  /// Everything that is known of the flags at one point of the code.
  struct Snapshot {
    FlagSources sources;
    uint32_t host_serial;
    HostFlags host_flags;
  };

  FlagTracker(const Machine& machine, const BlockPlan& plan, HostCode& code, RegisterMap& registers)
      : machine_(machine), plan_(plan), code_(code), registers_(registers) {}

  /// All flags are as the block before left them.
  void begin_block();
  /// An exit in front of the next step sees the flags as they are here.
  void mark_step() { flags_before_ = flags_; }
  /// In front of a step that writes registers: protects what is made from them.
  void begin_step(uint32_t written, uint8_t killed, uint8_t visible);
  /// After it: unless it said otherwise, the host's flags are no longer the guest's.
  void end_step();

  const FlagSources& sources() const { return flags_; }
  void restore_sources(const FlagSources& sources) { flags_ = sources; }
  Snapshot snapshot() const { return {flags_, host_serial_, host_flags_}; }
  /// What an exit in front of the present step sees, with nothing in the host's flags.
  Snapshot before_step() const { return {flags_before_, 0, HostFlags::nz}; }
  void restore(const Snapshot& snapshot);

  // What the present step's code does
  void set_sources(uint8_t which, FlagSource source);
  /// The host's flags are those of the present operation.
  void in_host(HostFlags which);
  /// The present step leaves the host's flags alone.
  void keep_host_flags() { host_kept_ = true; }
  /// The host's flags are of no use from here on.
  void drop_host_flags() { host_serial_ = 0; }
  /// Also, a carry that only the host had is lost.
  void forget_host_carries();
  /// Writes a value to a word put aside: an operand of flags.
  FlagOperand aside(const Gp& value);
  /// The host has the flags of the present operation now: writes them to the state.
  void settle_from_host(uint8_t which, const Gp& result, bool borrow);
  void settle_carries(uint8_t which);
  /// True if flags that are the host's need not be stored, since only the next step takes them.
  bool only_next_reads(uint8_t which) const;

  // What it needs
  /// Makes the host's carry flag C, or its inverse for a subtraction with borrow.
  void carry_to_host(bool borrow);
  /// Makes the host's flags tell a condition of the guest (not AL).
  Cond condition(unsigned guest_condition);
  /// Before registers are written: of flags that are made from these, that are not killed and that
  /// are visible, the operands are put aside, or the flags are computed.
  void protect(uint32_t written, uint8_t killed, uint8_t visible);
  /// Writes flags to the state.
  void settle(uint8_t which);
  void settle_all() { settle(flag::all); }

  // Exits and edges
  /// Leaves the pending flags uncomputed for the block at an address of the same page, if that one
  /// sets them all before anything but an exit sees them. False, and nothing done: it does not.
  bool leave_recoverable(uint32_t target);
  /// What the next block inherits.
  FlagSources outgoing() const;
  /// The number of a recipe for the flags, 0 if the state has them all.
  uint32_t recipe_of(const FlagSources& flags);
  /// The recipe of an exit in front of the present step.
  uint32_t recipe_before_step() { return recipe_of(flags_before_); }
  const FlagSources& recipe(uint32_t number) const { return recipes_[number]; }
  /// Drops all recipes.
  void forget() { recipes_.assign(1, {}); }

 private:
  bool die_in_block(uint8_t which) const;
  std::array<unsigned, 2> free_words() const;
  bool put_aside(uint8_t which, uint32_t registers, const unsigned* words, std::size_t count);
  void store_nz(const Gp& value);
  void compute(const FlagSource& source, const Gp& result);
  void compare(const FlagSource& source);
  void operand_to(const Gp& to, const FlagOperand& operand);
  asmjit::Operand simple_operand(const FlagOperand& operand, const Gp& scratch);
  bool host_has(const FlagSource& source, HostFlags least) const;
  Cond condition_from_memory(unsigned guest_condition);
  std::optional<Cond> condition_from_host(unsigned guest_condition);
  bool stays_recoverable(uint32_t target, uint32_t& written) const;

  const Machine& machine_;
  const BlockPlan& plan_;
  HostCode& code_;
  RegisterMap& registers_;
  asmjit::x86::Assembler& a_ = code_.assembler();
  std::vector<FlagSources> recipes_{1};
  FlagSources flags_;
  FlagSources flags_before_;  // at the beginning of the step
  uint32_t serial_ = 0;       // of the present operation
  // The operation whose flags are the host's, 0 for none, and which of them are.
  uint32_t host_serial_ = 0;
  HostFlags host_flags_ = HostFlags::nz;
  bool host_kept_ = false;
};

}  // namespace capsoc::armv7m
