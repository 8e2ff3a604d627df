#pragma once

#include <cstdint>

#include "cortex_m3/listeners.h"
#include "cortex_m3/memory/memory_access.h"
#include "cortex_m3/system/registers.h"

namespace capsoc::cortex_m3 {

class Machine;

/// The private peripheral bus (B3.1, C1.2): takes each access to the room whose register it is, and
/// what follows from it to the others. Addresses are aligned to the size of 1, 2 or 4 bytes.
class SystemSpace {
 public:
  explicit SystemSpace(Machine& machine) : machine_(machine) {}

  /// Without privilege only STIR answers, if CCR.USERSETMPEND lets it, and open stimulus ports.
  BusResult read(uint32_t address, unsigned size, uint32_t& value, bool privileged);
  BusResult write(uint32_t address, unsigned size, uint32_t value, bool privileged);
  /// The word at an address, without side effects.
  uint32_t peek(uint32_t address) const;

  // What is told once, of an instruction's accesses.
  /// A size that the register does not take.
  void check_access(const Step& op, uint32_t address, unsigned size);
  /// Settings that are UNPREDICTABLE, and priority bits that are not there.
  void check_write(const Step& op, uint32_t address, unsigned size, uint32_t value, bool done);
  void check_basepri(const Step& op, uint32_t value);

  /// A debugger's access: DEMCR.TRCENA is set.
  void enable_tracing();
  /// What has to be looked at at each instruction or access, from DEMCR and the DWT's registers.
  void select_observation();

 private:
  bool open_to_user(uint32_t address, bool write) const;
  uint32_t icsr() const;
  void write_word(const SystemRegister& target, uint32_t address, const LaneWrite& write);
  void write_icsr(uint32_t value);
  void write_interrupts(uint32_t address, const LaneWrite& write);
  void write_demcr(uint32_t value);
  void write_itm(uint32_t address, unsigned size, uint32_t value);
  void check_mpu(const Step& op, uint32_t address, uint32_t value);
  void check_priorities(const Step& op, uint32_t address, unsigned size, uint32_t value);
  void dropped_priority(const Step& op, const DroppedPriority& dropped);

  Machine& machine_;
};

}  // namespace capsoc::cortex_m3
