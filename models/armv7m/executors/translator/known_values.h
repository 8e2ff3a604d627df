#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "armv7m/executors/step.h"

namespace capsoc::armv7m {

class Machine;

/// The values of the guest's registers along a block, as far as they are easy to follow. Guesses,
/// made from the state in which the block is translated: they choose between ways of writing code,
/// and no code may depend on one being right.
class KnownValues {
 public:
  explicit KnownValues(const Machine& machine) : machine_(machine) {}

  /// The registers as they are now.
  void begin();
  /// Follows a step.
  void note(const Step& step);
  void forget(unsigned n) { values_[n].reset(); }
  /// Register n, 0 to 15.
  std::optional<uint32_t> operator[](unsigned n) const { return values_[n]; }

 private:
  std::optional<uint32_t> result_of(const Step& step) const;

  const Machine& machine_;
  std::array<std::optional<uint32_t>, 16> values_;
};

}  // namespace capsoc::armv7m
