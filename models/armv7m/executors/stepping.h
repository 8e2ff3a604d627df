#pragma once

#include <cstdint>
#include <vector>

#include "armv7m/executors/executor.h"
#include "armv7m/executors/step.h"

namespace capsoc::armv7m {

class Machine;

/// The reference: fetches, decodes and executes one instruction, and tells the observer.
class Stepping : public InstructionExecutor {
 public:
  explicit Stepping(Machine& machine) : machine_(machine) {}
  void run(uint64_t limit) override;
  /// Executes the next instruction if it is permitted; null permits all. False: it was not.
  bool step(bool (*permits)(const DecodedOp&));
  /// INVSTATE belongs to the instruction at the target (A2.3.1, BXWritePC: "on the next
  /// instruction"). It is raised by executing that one, and what cannot be fetched is not executed:
  /// a fault of the fetch comes first (B3.2.15, IACCVIOL and IBUSERR).
  void without_thumb();

 private:
  bool fetch(uint32_t address, uint16_t& halfword);
  void faulted();
  const Step& decoded(uint32_t address, uint16_t first, uint16_t second);

  Machine& machine_;
  // Each instruction is fetched, but not decoded, again: where blocks leave single instructions (at
  // the border of a page, twice a round of SHA-512), decoding took a third of the whole run.
  std::vector<Step> decoded_;
};

}  // namespace capsoc::armv7m
