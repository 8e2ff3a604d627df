#pragma once

#include <asmjit/x86.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cortex_m3/executors/translator/block_exit.h"
#include "cortex_m3/executors/translator/code_buffer.h"
#include "cortex_m3/executors/translator/flag_sources.h"
#include "cortex_m3/executors/translator/host_context.h"
#include "cortex_m3/isa/flag_liveness.h"
#include "cortex_m3/machine.h"

namespace capsoc::cortex_m3 {

/// Writes the host code of decoded blocks.
///
/// In it ten guest registers are in host registers (r0-r7, SP, LR), the others in the state, whose
/// address is in rbp; r15 is HostContext::budget; rax, rcx and rdx are free. The code calls
/// nothing: whatever it does not do itself it leaves to C++, by leaving with the number of a
/// BlockExit.
///
/// Flags are not computed where they are set but where they are needed (FlagSources): a comparison
/// becomes code at its branch, or at the way out of a block that somebody may see them at.
class BlockEmitter {
 public:
  using Gp = asmjit::x86::Gp;
  using Mem = asmjit::x86::Mem;
  using Label = asmjit::Label;
  using Cond = asmjit::x86::CondCode;

  BlockEmitter(Machine& machine, HostContext& context, CodeBuffer& buffer);
  BlockEmitter(const BlockEmitter&) = delete;
  BlockEmitter& operator=(const BlockEmitter&) = delete;

  /// The code that enters and leaves translated code; once, first in the buffer. Offset of the
  /// entry: uint32_t (State*, const void* code), which returns the number of the exit.
  std::size_t emit_frame();
  /// The code of a block, or null if there is nothing to gain or no room.
  const uint8_t* emit(const Step* head, CodePage& page);

  const std::vector<BlockExit>& exits() const { return exits_; }
  const FlagSources& recipe(uint32_t number) const { return recipes_[number]; }
  /// How far in front of a block's code those enter it who came by a branch that is still refilled
  /// (timing::refill_beyond).
  static constexpr int refill_bytes = 8;
  /// In front of that: the trails that the time of the block's first operation hangs on
  /// (timing::minded_by), for those who come from another page without a branch.
  static constexpr int minded_bytes = 16;
  /// Most cycles that translated code takes from one look at the budget to the next.
  uint32_t largest_bound() const { return largest_bound_; }
  /// All code was dropped.
  void forget();
  /// Whether emit() writes a listing, too; the last block's.
  void list(bool wanted) { listing_wanted_ = wanted; }
  std::string listing() const { return {log_.data(), log_.dataSize()}; }
  /// True if the buffer may be too full for another block.
  bool full() const { return buffer_.room() < largest_block || exits_.size() > most_exits; }

 private:
  static constexpr uint32_t most_cycles = 256;  // of a block; what is longer is cut
  static constexpr std::size_t largest_block = 64 << 10;
  static constexpr std::size_t most_exits = 1u << 20;
  struct Stub {
    Label label;
    uint32_t exit;
  };
  struct Constant {
    Label label;
    uint64_t value;
  };
  struct Slot {
    Label label, unlinked;  // where it is, and where it leads at first
    uint32_t exit;
  };
  /// A transfer to or from memory.
  struct Access {
    uint8_t size = 4;
    bool is_signed = false, store = false;
    bool aligned = false;  // known to be
    uint8_t rd = 0;
    uint8_t ra = FlagOperand::none;  // LDRD and STRD: the second register
    uint16_t list = 0;               // of LDM and STM, instead
    unsigned words() const;
  };
  /// Its address: base + (index << shift) + imm.
  struct Address {
    uint8_t base = FlagOperand::none, index = FlagOperand::none, shift = 0;
    uint32_t imm = 0;
  };
  struct SlowAccess {
    Label entry, back, exit;
    Access access;
    Address address;
    int window = -1;
  };
  struct JumpMiss {
    Label entry, back, exit;
  };
  enum class HostFlags : uint8_t { nz, shift, sum, difference };  // shift: N, Z and C
  struct TakenBranch {
    Label label;
    const Step* step;
    FlagSources flags;
    uint32_t host_serial;
    HostFlags host_flags;
  };
  // block_emitter.cpp: the block
  void begin(const Step* head, CodePage& page);
  const uint8_t* finish();
  void collect_steps();
  void split();
  void find_visible_flags();
  void emit_steps();
  void emit_step(const Step& step);
  void emit_operation(const Step& step);
  void emit_cold();
  void emit_data_area();
  bool writes_sp(const Step& step) const;
  bool is_translated(const Step& step) const;
  uint32_t bound_of(const Step& step) const;
  bool may_be_left_at(const Step& step) const;
  static uint32_t written_by(const DecodedOp& op);
  Label exit_at(const Step& step);
  Label stub(const BlockExit& exit);
  Mem constant(uint64_t value);
  /// Leaves the rest of the block to C++.
  void give_up(const Step& step) {
    a_.jmp(exit_at(step));
    open_ = false;
  }

  // emit_conditional.cpp: steps of IT blocks
  enum class GroupForm : uint8_t { jump, moves, masked };
  void emit_conditional_group();
  std::size_t end_of_group(std::size_t begin) const;
  uint8_t visible_behind_group(std::size_t begin, std::size_t end) const;
  GroupForm form_of_group(std::size_t end) const;
  void emit_moves(std::size_t end, Cond condition);
  void emit_move(const Step& step, Cond condition);
  void emit_masked(std::size_t end, Cond condition);
  static std::optional<FlagOperand> moved_by(const Step& step);
  static std::optional<asmjit::x86::Inst::Id> masked_by(const Step& step);

  // emit_listing.cpp
  void begin_listing();
  void list_step(const Step& step);
  void list_line(const char* text);

  // block_emitter.cpp: registers
  static constexpr unsigned literal_pc = 15;
  static bool pinned(unsigned n);
  /// Operands as asmjit has them.
  static asmjit::Imm number(uint32_t value);
  static Mem sum_of(const Gp& base, int32_t displacement);
  static Mem sum_of(const Gp& base, const Gp& index, unsigned shift = 0, int32_t displacement = 0);
  static Gp host(unsigned n);
  Mem in_state(unsigned n) const;
  asmjit::Operand at(unsigned n) const;
  Gp read(unsigned n, const Gp& scratch);
  void read_to(const Gp& to, unsigned n);
  void write(unsigned n, const Gp& from);
  Gp destination(unsigned n, const Gp& scratch) const { return pinned(n) ? host(n) : scratch; }
  void written(unsigned n, const Gp& from) {
    if (!pinned(n)) write(n, from);
  }
  Mem state_word(const void* member) const;
  Mem state_byte(const void* member) const;
  Mem context(const void* member, unsigned size = 8) const;

  // emit_flags.cpp
  void set_sources(uint8_t which, FlagSource source);
  void in_host(HostFlags which);
  void protect(uint32_t written, uint8_t killed, uint8_t visible);
  bool die_in_block(uint8_t which) const;
  bool only_next_reads(uint8_t which) const;
  void forget_host_carries();
  std::array<unsigned, 2> free_words() const;
  bool put_aside(uint8_t which, uint32_t registers, const unsigned* words, std::size_t count);
  FlagOperand aside(const Gp& value);
  void settle(uint8_t which);
  void settle_all() { settle(flag::all); }
  void settle_carries(uint8_t which);
  void store_nz(const Gp& value);
  void compute(const FlagSource& source, const Gp& result);
  void compare(const FlagSource& source);
  void operand_to(const Gp& to, const FlagOperand& operand);
  asmjit::Operand simple_operand(const FlagOperand& operand, const Gp& scratch);
  bool host_has(const FlagSource& source, HostFlags least) const;
  Cond condition(unsigned guest_condition);
  Cond condition_from_memory(unsigned guest_condition);
  std::optional<Cond> condition_from_host(unsigned guest_condition);
  uint32_t recipe_of(const FlagSources& flags);
  FlagSources outgoing() const;
  bool stays_recoverable(uint32_t target, uint32_t& written) const;
  bool leave_recoverable(uint32_t target);
  uint8_t wanted(const Step& step) const { return step.set_flags ? visible_[index_] : 0; }
  void keep_host_flags() { host_kept_ = true; }

  // emit_system.cpp
  static bool stands_alone(const Step& step);
  static bool moves_stack_pointer(const Step& step);
  void emit_stack_pointer(const Step& step);

  // emit_counts.cpp: while executions are counted; they change rax, rdx and the host's flags
  void count(uint64_t* counter);
  void count_departure(const Step& step);

  // emit_data.cpp
  void emit_data(const Step& step);
  void emit_logical(const Step& step);
  void emit_test(const Step& step);
  void emit_arithmetic(const Step& step);
  void emit_compare(const Step& step);
  void emit_difference(const Step& step, bool reversed);
  void emit_sum(const Step& step);
  void emit_with_carry(const Step& step);
  void emit_high(const Step& step);
  void emit_sp(const Step& step);
  void carry_to_host(bool borrow);
  bool store_shifter_carry(const Step& step) const;
  asmjit::Operand second_operand(const Step& step, const Gp& scratch, bool carry);
  static Gp shift_place(const Step& step);
  static bool works_in_state(const Step& step, const asmjit::Operand& second);
  static bool leaves_host_flags(const Shift& shift);
  void shift_constant(const Gp& to, unsigned rm, Shift shift, bool carry);
  void set_source_of(const Step& step, FlagSource::Of of, FlagOperand x, FlagOperand y,
                     bool writes);
  void settle_from_host(uint8_t which, const Gp& result, bool borrow);

  // emit_bits.cpp
  void emit_shift_by_register(const Step& step);
  void emit_shift_with_carry(const Step& step);
  void emit_extract(const Step& step);
  void emit_extend(const Step& step);
  void emit_insert(const Step& step);
  void emit_reverse(const Step& step);

  // emit_multiply.cpp
  void emit_multiply(const Step& step);
  void emit_long_multiply(const Step& step);
  void emit_divide(const Step& step);
  void charge(const Gp& cycles);

  // emit_memory.cpp
  void emit_transfer(const Step& step);
  void emit_single(const Step& step);
  void emit_dual(const Step& step);
  void emit_multiple(const Step& step);
  void emit_literal(const Step& step, uint32_t address);
  void emit_access(const Step& step, const Access& access, const Address& address);
  unsigned through_window(const Address& address, const Access& access, int number,
                          const Label& otherwise);
  bool reaches_directly(const Address& address, const Access& access, int number) const;
  Mem straight_through_window(const Address& address, const Access& access, int number,
                              const Label& otherwise);
  const MemoryWindow& window(const Access& access, int number) const;
  void charge_waits(const Access& access, int window);
  void emit_beside_code(const Address& address, const Access& access, const Label& exit);
  void emit_slow(const SlowAccess& slow);
  void emit_unaligned(const SlowAccess& slow);
  void emit_return(const Step& step, const Access& access, const Address& address,
                   const asmjit::Imm& moved);
  void look_up(const Address& address, const Access& access, const Label& exit);
  void transfer(const Access& access, const Mem& place);
  void move(const Access& access, unsigned n, const Mem& at);
  void address_to(const Gp& to, const Address& address, uint32_t less);
  int window_of(const Address& address, bool store) const;
  std::optional<uint32_t> guess(const Address& address) const;
  void note_values(const Step& step);

  // emit_branch.cpp
  void emit_branch(const Step& step);
  void emit_conditional_branch(const Step& step, Cond taken);
  void emit_edge(const Step& step, uint32_t target, unsigned refill);
  void emit_indirect(const Step& step);
  void emit_table_branch(const Step& step);
  void find_entry(const Step& step);
  Mem jump(const void* of, const Gp& index) const;
  void emit_miss(const JumpMiss& miss);
  void go_to_entry(const Step& step, unsigned refill);
  void emit_close(const Step& step);
  static uint64_t cost(const Step& step, unsigned refill);
  void emit_entries();
  int32_t in_code_page(const void* member) const;

  Machine& machine_;
  HostContext& context_;
  CodeBuffer& buffer_;
  class Errors : public asmjit::ErrorHandler {
   public:
    void handleError(asmjit::Error, const char*, asmjit::BaseEmitter*) override { any = true; }
    bool any = false;
  };
  Errors errors_;
  asmjit::CodeHolder code_;
  asmjit::StringLogger log_;
  bool listing_wanted_ = false;
  asmjit::x86::Assembler a_;
  std::vector<BlockExit> exits_;
  std::vector<FlagSources> recipes_;
  uint32_t largest_bound_ = 0;

  // Of the block that is being written
  const Step* head_ = nullptr;
  CodePage* page_ = nullptr;
  std::vector<const Step*> steps_;
  std::vector<uint8_t> visible_;  // of each step: flags that somebody may see behind it
  std::size_t index_ = 0;
  uint32_t bound_ = 0;   // cycles it can take at most
  std::size_t cut_ = 0;  // the step from which on it would take too many
  Step close_;           // stands for that step, if another block may begin with it
  bool open_ = false;    // execution reaches the end of what was written
  FlagSources flags_;
  FlagSources flags_before_;  // at the beginning of the step
  uint32_t serial_ = 0;
  // The operation whose flags are the host's, 0 for none, and which of them are.
  uint32_t host_serial_ = 0;
  HostFlags host_flags_ = HostFlags::nz;
  bool host_kept_ = false;  // the present step leaves the host's flags alone
  std::array<std::optional<uint32_t>, 16> values_;  // of registers, as far as they can be guessed
  Label refilled_entry_, entry_;
  std::vector<Stub> stubs_;
  std::vector<Constant> constants_;
  std::vector<Slot> slots_;
  std::vector<SlowAccess> slow_;
  std::vector<JumpMiss> misses_;
  std::vector<TakenBranch> taken_;
  std::vector<std::pair<const Step*, Label>> step_exits_;
};

}  // namespace capsoc::cortex_m3
