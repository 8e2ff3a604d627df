#include "bus/address_decoder.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace capsoc::bus {

AddressDecoder::AddressDecoder(AddressMap map) : map_(std::move(map)), error_(validate(map_)) {
  if (!error_.empty()) return;
  for (std::size_t i = 0; i < map_.size(); ++i) by_base_.push_back(i);
  std::sort(by_base_.begin(), by_base_.end(),
            [this](std::size_t a, std::size_t b) { return map_[a].base < map_[b].base; });
}

Decoded AddressDecoder::decode(uint64_t address) const {
  const auto above =
      std::upper_bound(by_base_.begin(), by_base_.end(), address,
                       [this](uint64_t a, std::size_t i) { return a < map_[i].base; });
  Decoded result;
  result.window_last =
      above == by_base_.end() ? std::numeric_limits<uint64_t>::max() : map_[*above].base - 1;
  if (above == by_base_.begin()) return result;
  const std::size_t index = *(above - 1);
  const MapEntry& entry = map_[index];
  if (address > entry.last()) {
    result.window_base = entry.last() + 1;
    return result;
  }
  const uint64_t within = (address - entry.base) % entry.window();
  result.entry = &entry;
  result.index = index;
  result.local = entry.offset + within;
  result.window_base = address - within;
  result.window_last = result.window_base + entry.window() - 1;
  return result;
}

}  // namespace capsoc::bus
