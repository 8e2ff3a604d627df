// From a bus address to the map entry that answers and the address inside its target.
#pragma once

#include <cstdint>
#include <vector>

#include "bus/address_map.h"

namespace capsoc::bus {

/// Result of decoding an address. `entry` is nullptr if no target answers.
struct Decoded {
  const MapEntry* entry = nullptr;
  std::size_t index = 0;     ///< of the entry in the map given to the decoder
  uint64_t local = 0;        ///< address inside the target
  uint64_t window_base = 0;  ///< bus address of the first byte of the window (or of the gap)
  uint64_t window_last = 0;  ///< bus address of its last byte, inclusive
};

/// Binary search over a valid map. With an invalid map no address is decoded, and error() says why.
class AddressDecoder {
 public:
  explicit AddressDecoder(AddressMap map);

  Decoded decode(uint64_t address) const;
  const AddressMap& map() const { return map_; }
  const std::string& error() const { return error_; }

 private:
  AddressMap map_;
  std::string error_;
  std::vector<std::size_t> by_base_;  // indices into map_, ascending base
  mutable std::size_t latest_ = 0;    // of map_: the next address is often the same entry's

  std::size_t entries_to(uint64_t address) const;
};

}  // namespace capsoc::bus
