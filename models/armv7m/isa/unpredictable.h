#pragma once

#include <cstdint>
#include <optional>

#include "armv7m/isa/op.h"

namespace capsoc::armv7m {

/// The rows of unpredictable.def.
enum class Unpredictable : uint8_t {
#define UNPREDICTABLE(name, section, what, choice) name,
#include "armv7m/isa/unpredictable.def"
#undef UNPREDICTABLE
  count
};

/// What the architecture says, or does not say, about a case and what this processor does.
struct UnpredictableCase {
  const char* name;
  const char* section;  ///< of ARM DDI 0403
  const char* what;
  const char* choice;
};
const UnpredictableCase& describe(Unpredictable which);

/// The first case that a decoded instruction is, whatever the registers hold; none for most.
std::optional<Unpredictable> unpredictable_encoding(const DecodedOp& op);

}  // namespace capsoc::armv7m
