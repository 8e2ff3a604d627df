#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "armv7m/executors/translator/block_edges.h"
#include "armv7m/executors/translator/block_plan.h"
#include "armv7m/executors/translator/code_buffer.h"
#include "armv7m/executors/translator/data_operations.h"
#include "armv7m/executors/translator/device_calls.h"
#include "armv7m/executors/translator/flag_tracker.h"
#include "armv7m/executors/translator/floating_operations.h"
#include "armv7m/executors/translator/host_code.h"
#include "armv7m/executors/translator/known_values.h"
#include "armv7m/executors/translator/memory_paths.h"
#include "armv7m/executors/translator/register_map.h"
#include "armv7m/executors/translator/step_calls.h"
#include "armv7m/executors/translator/transfers.h"

namespace capsoc::armv7m {

class Machine;

/// Makes host code of decoded blocks. Owns the parts that write it, and decides which of them
/// writes a step.
///
/// Whatever the code does not do itself it leaves to C++, by leaving with the number of a
/// BlockExit. It calls executors of the DSP and the floating-point extension, which touch registers
/// and their flags alone, and devices that answer at once (DeviceCalls).
class BlockCompiler {
 public:
  /// Nothing is owned; `context` lies near the machine's state (HostCode).
  BlockCompiler(Machine& machine, HostContext& context, CodeBuffer& buffer);
  BlockCompiler(const BlockCompiler&) = delete;
  BlockCompiler& operator=(const BlockCompiler&) = delete;

  /// The code that enters and leaves translated code; once, first in the buffer. Offset of the
  /// entry: uint32_t (State*, const void* code), which returns the number of the exit.
  std::size_t emit_frame();
  /// The code of a block, or null if there is nothing to gain or no room.
  const uint8_t* emit(const Step* head, CodePage& page);

  const std::vector<BlockExit>& exits() const { return edges_.exits(); }
  /// By BlockExit::recipe.
  const FlagSources& recipe(uint32_t number) const { return flags_.recipe(number); }
  /// Most cycles that translated code takes from one look at the budget to the next.
  uint32_t largest_bound() const { return largest_bound_; }
  /// All code was dropped.
  void forget();
  /// Whether emit() writes a listing, too; the last block's.
  void list(bool wanted) { code_.list(wanted); }
  std::string listing() const { return code_.listing(); }
  /// True if the buffer may be too full for another block.
  bool full() const { return buffer_.room() < largest_block || edges_.exits().size() > most_exits; }

 private:
  static constexpr std::size_t largest_block = 64 << 10;
  static constexpr std::size_t most_exits = 1u << 20;

  void begin(const Step* head, CodePage& page);
  const uint8_t* finish();
  void emit_steps();
  void emit_step(const Step& step);
  void emit_operation(const Step& step);
  void emit_stack_pointer(const Step& step);
  void go_to(std::size_t i);

  // conditional_group.cpp: steps of IT blocks
  enum class GroupForm : uint8_t { jump, moves, masked };
  void emit_conditional_group();
  void emit_jump_over(std::size_t end, uint32_t written, bool sets, uint8_t visible);
  GroupForm form_of_group(std::size_t end) const;
  void emit_moves(std::size_t end, Cond condition);
  void emit_move(const Step& step, Cond condition);
  void emit_masked(std::size_t end, Cond condition);
  static std::optional<FlagOperand> moved_by(const Step& step);
  static std::optional<asmjit::x86::Inst::Id> masked_by(const Step& step);

  Machine& machine_;
  HostContext& context_;
  CodeBuffer& buffer_;
  HostCode code_;
  asmjit::x86::Assembler& a_ = code_.assembler();
  BlockPlan plan_;
  KnownValues values_;
  RegisterMap registers_;
  FlagTracker flags_;
  BlockEdges edges_;
  DeviceCalls devices_;
  MemoryPaths memory_;
  Transfers transfers_;
  DataOperations data_;
  StepCalls calls_;
  FloatingOperations floating_;
  uint32_t largest_bound_ = 0;
};

}  // namespace capsoc::armv7m
