// What can be read of a simulation at one instant, and how two instants differ.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "service/board.h"
#include "service/message.h"

namespace capsoc::service {

struct Picture {
  static constexpr uint32_t page = 4096;

  Position position;
  Json processor, devices;                ///< values by names
  std::map<uint32_t, std::string> pages;  ///< of memory, by address; what is not there is 0

  static Picture of(Board& board);
  /// For another process.
  Json pack(Frames& frames) const;
  static Picture unpack(const Json& about, const Frames& frames);
};

/// {"processor", "devices": name to [one, other]; "memory": list of {"name", "address", "one",
/// "other"}, of bytes without a variable texts of hexadecimal digits; "left_out": entries beyond
/// 1000}. The names come from the board's program.
Json difference(Board& board, const Picture& one, const Picture& other);

}  // namespace capsoc::service
