#pragma once

#include <cstdint>
#include <optional>

#include "cortex_m3/isa/op.h"

namespace capsoc::cortex_m3 {

/// The rows of unpredictable.def.
enum class Unpredictable : uint8_t {
#define UNPREDICTABLE(name, section, what, choice) name,
#include "cortex_m3/isa/unpredictable.def"
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

}  // namespace capsoc::cortex_m3
