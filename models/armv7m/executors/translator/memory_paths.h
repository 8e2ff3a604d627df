#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "armv7m/executors/translator/block_edges.h"
#include "armv7m/executors/translator/device_calls.h"
#include "armv7m/executors/translator/host_code.h"
#include "armv7m/executors/translator/host_context.h"
#include "armv7m/executors/translator/known_values.h"
#include "armv7m/executors/translator/register_map.h"

namespace capsoc::armv7m {

class Machine;

/// The ways of an access to memory: through a window (one comparison), after the block through
/// the page table or byte by byte, and else to C++ by the exit of its step. Takes the wait states
/// from the budget. Changes rax, rcx, rdx and the host's flags.
class MemoryPaths {
 public:
  /// A transfer to or from memory.
  struct Access {
    uint8_t size = 4;  ///< bytes: 1, 2 or 4
    bool is_signed = false, store = false;
    bool aligned = false;    ///< known to be
    bool exclusive = false;  ///< faults if it is not
    uint8_t rd = 0;
    uint8_t ra = FlagOperand::none;  ///< LDRD and STRD: the second register
    uint16_t list = 0;               ///< of LDM and STM, instead
    uint8_t singles = 0;             ///< or how many floating-point registers from a first one on
    uint8_t first_single = 0;
    unsigned words() const;
  };
  /// Its address: base + (index << shift) + imm.
  struct Address {
    uint8_t base = FlagOperand::none, index = FlagOperand::none, shift = 0;
    uint32_t imm = 0;
  };

  MemoryPaths(const Machine& machine, const HostContext& context, const BlockPlan& plan,
              HostCode& code, RegisterMap& registers, const KnownValues& values, BlockEdges& edges,
              DeviceCalls& devices)
      : machine_(machine),
        context_(context),
        plan_(plan),
        code_(code),
        registers_(registers),
        values_(values),
        edges_(edges),
        devices_(devices) {}

  void begin() { slow_.clear(); }
  /// All of an access, by whatever way.
  void emit_access(const Step& step, const Access& access, const Address& address);
  /// What is outside the windows, after the block.
  void emit_slow_ways();

  /// `to` = the address, less a number. Changes eax and ecx, too.
  void address_to(const Gp& to, const Address& address, uint32_t less);

  // The parts of an access that must be made by a window
  /// The number of the window that an access probably goes to; below zero if there is none.
  int window_of(const Address& address, bool store) const;
  /// Computes the place of an access, at rcx + (rax << result), or goes to a label.
  unsigned through_window(const Address& address, const Access& access, int number,
                          const Label& otherwise);
  /// Takes the wait states of a window's access from the budget.
  void charge_waits(const Access& access, int window);
  /// Moves all registers of an access; `place` is the first word's.
  void transfer(const Access& access, const Mem& place);

 private:
  struct SlowAccess {
    Label entry, back, exit;
    Access access;
    Address address;
    int window = -1;
  };

  bool reaches_directly(const Address& address, const Access& access, int number) const;
  Mem straight_through_window(const Address& address, const Access& access, int number,
                              const Label& otherwise);
  const MemoryWindow& window(const Access& access, int number) const;
  void emit_beside_code(const Address& address, const Access& access, const Label& exit,
                        const Label& unmapped);
  void emit_slow(const SlowAccess& slow);
  void emit_unaligned(const SlowAccess& slow);
  void look_up(const Address& address, const Access& access, const Label& exit,
               const Label& unmapped);
  Label where_unmapped(const Step& step, const Access& access, const Address& address);
  void move(const Access& access, unsigned n, const Mem& at);
  void transfer_singles(const Access& access, const Mem& place);
  std::optional<uint32_t> guess(const Address& address) const;

  const Machine& machine_;
  const HostContext& context_;
  const BlockPlan& plan_;
  HostCode& code_;
  RegisterMap& registers_;
  const KnownValues& values_;
  BlockEdges& edges_;
  DeviceCalls& devices_;
  asmjit::x86::Assembler& a_ = code_.assembler();
  std::vector<SlowAccess> slow_;
};

}  // namespace capsoc::armv7m
