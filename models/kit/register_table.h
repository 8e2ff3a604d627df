#pragma once

#include <cstddef>
#include <stdexcept>

#include "kit/register_description.h"

namespace capsoc::kit {

/// The entry of a generated table for `offset`. An offset without an entry does not compile when
/// the call is constant and throws at elaboration otherwise.
template <std::size_t N>
constexpr const registers::RegisterDescription& describe(
    const registers::RegisterDescription (&table)[N], uint32_t offset) {
  for (const auto& entry : table) {
    if (entry.offset == offset) return entry;
  }
  throw std::logic_error("no register at this offset in the description");
}

}  // namespace capsoc::kit
