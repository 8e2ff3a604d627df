#pragma once

#include <cstdint>
#include <vector>

#include "armv7m/executors/translator/block_edges.h"
#include "armv7m/executors/translator/flag_tracker.h"
#include "armv7m/executors/translator/host_code.h"
#include "armv7m/executors/translator/host_context.h"
#include "armv7m/executors/translator/register_map.h"

namespace capsoc::armv7m {

class Machine;

/// Loads and stores of one register at addresses where devices probably are. Translated code calls
/// the device without leaving itself, if it answers at once (MemoryAccess::load_at_once); else it
/// exits in front of the step. The block ends after the access, as it does for every executor: what
/// follows depends on what the device has done.
class DeviceCalls {
 public:
  /// What is moved: `size` bytes to or from register `rd`.
  struct Move {
    uint8_t size = 4, rd = 0;
    bool is_signed = false, store = false;
  };

  /// Nothing is owned. `context`: gets the functions that the code calls.
  DeviceCalls(const Machine& machine, HostContext& context, HostCode& code, RegisterMap& registers,
              FlagTracker& flags, BlockEdges& edges);

  void begin() { calls_.clear(); }
  /// True if a call can do all of a step, and devices are at `address` in the default map.
  bool has_call(const Step& step, uint32_t address) const;
  /// The place to go to with the address in eax, known to be aligned, instead of the step's exit.
  Label call(const Step& step, const Move& move);
  /// The calls, after the block.
  void emit();

 private:
  struct Call {
    Label entry, exit;
    const Step* step;
    Move move;
    FlagTracker::Snapshot flags;
  };

  void emit_call(const Call& call);
  uint8_t settle_flags(const Call& call);

  const Machine& machine_;
  const HostContext& context_;
  HostCode& code_;
  RegisterMap& registers_;
  FlagTracker& flags_;
  BlockEdges& edges_;
  asmjit::x86::Assembler& a_ = code_.assembler();
  std::vector<Call> calls_;
};

}  // namespace capsoc::armv7m
