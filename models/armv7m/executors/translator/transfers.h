#pragma once

#include <cstdint>

#include "armv7m/executors/translator/block_edges.h"
#include "armv7m/executors/translator/memory_paths.h"

namespace capsoc::armv7m {

class Machine;

/// The instructions that access memory: loads and stores of one, two or several registers, and the
/// table branches. What each transfers and what it does to its base; the way is MemoryPaths'.
class Transfers {
 public:
  Transfers(const Machine& machine, const HostContext& context, const BlockPlan& plan,
            HostCode& code, RegisterMap& registers, FlagTracker& flags, BlockEdges& edges,
            MemoryPaths& memory)
      : machine_(machine),
        context_(context),
        plan_(plan),
        code_(code),
        registers_(registers),
        flags_(flags),
        edges_(edges),
        memory_(memory) {}

  void emit_transfer(const Step& step);
  /// TBB, TBH.
  void emit_table_branch(const Step& step);

 private:
  using Access = MemoryPaths::Access;
  using Address = MemoryPaths::Address;

  void emit_single(const Step& step);
  void emit_dual(const Step& step);
  void emit_exclusive(const Step& step);
  void emit_multiple(const Step& step);
  void emit_literal(const Step& step, uint32_t address);
  void emit_return(const Step& step, const Access& access, const Address& address,
                   const asmjit::Imm& moved);

  const Machine& machine_;
  const HostContext& context_;
  const BlockPlan& plan_;
  HostCode& code_;
  RegisterMap& registers_;
  FlagTracker& flags_;
  BlockEdges& edges_;
  MemoryPaths& memory_;
  asmjit::x86::Assembler& a_ = code_.assembler();
};

}  // namespace capsoc::armv7m
