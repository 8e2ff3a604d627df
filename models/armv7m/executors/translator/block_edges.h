#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "armv7m/executors/translator/block_exit.h"
#include "armv7m/executors/translator/block_plan.h"
#include "armv7m/executors/translator/code_buffer.h"
#include "armv7m/executors/translator/flag_tracker.h"
#include "armv7m/executors/translator/host_code.h"
#include "armv7m/executors/translator/host_context.h"
#include "armv7m/executors/translator/register_map.h"

namespace capsoc::armv7m {

class Machine;

/// How execution enters a block and leaves it: entries, edges to other blocks, indirect branches,
/// and exits to C++, each with a number. Every edge takes the block's cycles and instructions from
/// the budget, and leaves to C++ once that is below zero.
class BlockEdges {
 public:
  /// How far in front of a block's code execution enters it by a branch that is still refilled
  /// (timing::refill_beyond), in bytes.
  static constexpr int refill_bytes = 8;
  /// In front of that: the trails that the time of the block's first operation depends on
  /// (timing::minded_by), for edges from another page without a branch.
  static constexpr int minded_bytes = 16;

  BlockEdges(const Machine& machine, const HostContext& context, const BlockPlan& plan,
             HostCode& code, RegisterMap& registers, FlagTracker& flags)
      : machine_(machine),
        context_(context),
        plan_(plan),
        code_(code),
        registers_(registers),
        flags_(flags) {}

  /// Begins a block. Exits of the blocks before it keep their numbers.
  void begin();
  /// Writes what precedes the code of a block, minded_bytes long.
  void emit_entries();

  /// Whether execution reaches the end of what was written so far.
  bool open() const { return open_; }
  void reopen() { open_ = true; }

  /// The exit in front of a step: C++ executes it, decoded, and the rest of the block.
  Label exit_at(const Step& step);
  /// Leaves the rest of the block to C++.
  void give_up(const Step& step);
  /// B, B<c>, CBZ, CBNZ, BL, BX, BLX.
  void emit_branch(const Step& step);
  /// BX, BLX, MOV and ADD to the PC.
  void emit_indirect(const Step& step);
  /// The way on after an access to a device, which leaves nothing in the pipeline.
  void emit_edge_behind_device(const Step& step) {
    emit_edge(step, next_address(step), 0, timing::no_trail);
  }
  /// The end of a block that runs into the next address.
  void emit_close(const Step& step);
  /// rcx = the translated code at eax, whose bit 0 has to be set; leaves in front of the step if
  /// there is none. EXC_RETURN never has any. Changes rdx, too; State::pc has the address then.
  void find_entry(const Step& step);
  /// After find_entry(): accounts for the block, and jumps.
  void go_to_entry(const Step& step, unsigned refill);
  /// Increments a counter of executions. Changes rax and the host's flags.
  void count(uint64_t* counter);

  // What is rarely executed, after the block, in this order
  void emit_taken();
  void emit_misses();
  void emit_exits();
  /// The words through which edges within the page jump, after the constants.
  void embed_slots();
  /// Points these to their exits. `start`: offset of the block's code in the buffer.
  void link(const CodeBuffer& buffer, std::size_t start);

  /// Of all blocks since forget(), by their numbers.
  const std::vector<BlockExit>& exits() const { return exits_; }
  void forget() { exits_.clear(); }

 private:
  struct Stub {
    Label label;
    uint32_t exit;
  };
  struct Slot {
    Label label, unlinked;  // where it is, and where it leads at first
    uint32_t exit;
  };
  struct JumpMiss {
    Label entry, back, exit;
  };
  struct TakenBranch {
    Label label;
    const Step* step;
    FlagTracker::Snapshot flags;
  };

  Label stub(const BlockExit& exit);
  void emit_conditional_branch(const Step& step, Cond taken);
  void emit_edge(const Step& step, uint32_t target, unsigned refill) {
    const auto behind = static_cast<timing::Trail>(step.trail);
    emit_edge(step, target, refill, refill != 0 ? timing::trail_refill : behind);
  }
  void emit_edge(const Step& step, uint32_t target, unsigned refill, timing::Trail trail);
  void jump_to_page(uint32_t target, unsigned refill, uint16_t trail, const Label& out);
  Mem jump(const void* of, const Gp& index) const;
  void emit_miss(const JumpMiss& miss);
  void count_departure(const Step& step);
  static uint64_t cost(const Step& step, unsigned refill);

  const Machine& machine_;
  const HostContext& context_;
  const BlockPlan& plan_;
  HostCode& code_;
  RegisterMap& registers_;
  FlagTracker& flags_;
  asmjit::x86::Assembler& a_ = code_.assembler();
  std::vector<BlockExit> exits_;
  bool open_ = false;
  Label refilled_entry_, entry_;
  std::vector<Stub> stubs_;
  std::vector<Slot> slots_;
  std::vector<JumpMiss> misses_;
  std::vector<TakenBranch> taken_;
  std::vector<std::pair<const Step*, Label>> step_exits_;
};

}  // namespace capsoc::armv7m
