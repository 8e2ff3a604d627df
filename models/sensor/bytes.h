// Numbers in the bytes of a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace capsoc::sensor {

/// A number in the host's own bytes from `bytes`, which holds it whole; reversed: the file has the
/// other order.
template <typename Number>
Number number_at(std::string_view bytes, std::size_t place, bool reversed = false) {
  char copy[sizeof(Number)];
  std::memcpy(copy, bytes.data() + place, sizeof copy);
  if (reversed)
    for (std::size_t i = 0; i < sizeof copy / 2; ++i) {
      const char kept = copy[i];
      copy[i] = copy[sizeof copy - 1 - i];
      copy[sizeof copy - 1 - i] = kept;
    }
  Number number;
  std::memcpy(&number, copy, sizeof copy);
  return number;
}

}  // namespace capsoc::sensor
