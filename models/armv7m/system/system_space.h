#pragma once

#include <cstdint>

#include "armv7m/core_context.h"
#include "armv7m/memory/memory_access.h"
#include "armv7m/memory/private_bus.h"
#include "armv7m/pending_exceptions.h"
#include "armv7m/system/registers.h"

namespace capsoc::armv7m {

/// The private peripheral bus (B3.1, C1.2): passes each access to the block that has the register,
/// and its consequences to the other blocks.
class SystemSpace : public PrivateBus {
 public:
  /// Nothing is owned.
  SystemSpace(CoreContext& context, PendingExceptions& pending, MemoryAccess& memory)
      : context_(context), pending_(pending), memory_(memory) {}

  /// Unprivileged accesses reach only open stimulus ports, and STIR if CCR.USERSETMPEND is set.
  BusResult read(uint32_t address, unsigned size, uint32_t& value, bool privileged) override;
  BusResult write(uint32_t address, unsigned size, uint32_t value, bool privileged) override;
  uint32_t peek(uint32_t address) const override;

  void check_access(const DecodedOp& op, uint32_t address, unsigned size) override;
  void check_write(const DecodedOp& op, uint32_t address, unsigned size, uint32_t value,
                   bool done) override;
  void check_basepri(const DecodedOp& op, uint32_t value);

  /// A debugger's access: DEMCR.TRCENA is set.
  void enable_tracing();
  /// Derives from DEMCR and the DWT's registers what has to be checked at each instruction or
  /// access.
  void select_observation();

 private:
  const SystemRegister* find(uint32_t address) const;
  bool is_itm(uint32_t address) const;
  bool open_to_user(uint32_t address, bool write) const;
  uint32_t icsr() const;
  void write_word(const SystemRegister& target, uint32_t address, const LaneWrite& write);
  void write_icsr(uint32_t value);
  void write_interrupts(const SystemRegister& target, uint32_t address, const LaneWrite& write);
  void write_demcr(uint32_t value);
  void write_itm(uint32_t address, unsigned size, uint32_t value);
  void check_mpu(const DecodedOp& op, uint32_t address, uint32_t value);
  void check_priorities(const DecodedOp& op, const SystemRegister& target, uint32_t address,
                        unsigned size, uint32_t value);
  void dropped_priority(const DecodedOp& op, const DroppedPriority& dropped);

  CoreContext& context_;
  PendingExceptions& pending_;
  MemoryAccess& memory_;
};

}  // namespace capsoc::armv7m
