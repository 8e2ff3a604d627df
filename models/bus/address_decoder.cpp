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

/// How many entries of by_base_ begin at or before the address.
std::size_t AddressDecoder::entries_to(uint64_t address) const {
  const auto above =
      std::upper_bound(by_base_.begin(), by_base_.end(), address,
                       [this](uint64_t a, std::size_t i) { return a < map_[i].base; });
  return static_cast<std::size_t>(above - by_base_.begin());
}

Decoded AddressDecoder::decode(uint64_t address) const {
  const auto answers = [&](const MapEntry& entry) { return address - entry.base < entry.size; };
  Decoded result;
  if (by_base_.empty() || !answers(map_[latest_])) {
    const std::size_t count = entries_to(address);
    const bool is_last = count == by_base_.size();
    result.window_last =
        is_last ? std::numeric_limits<uint64_t>::max() : map_[by_base_[count]].base - 1;
    if (count == 0) return result;
    const std::size_t index = by_base_[count - 1];
    if (!answers(map_[index])) {
      result.window_base = map_[index].last() + 1;
      return result;
    }
    latest_ = index;
  }
  const MapEntry& entry = map_[latest_];
  uint64_t within = address - entry.base;
  if (within >= entry.window()) within %= entry.window();
  result.entry = &entry;
  result.index = latest_;
  result.local = entry.offset + within;
  result.window_base = address - within;
  result.window_last = result.window_base + entry.window() - 1;
  return result;
}

}  // namespace capsoc::bus
