// Damage by number: the same number gives the same damage on every machine.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <string>

#include "base/random.h"

namespace capsoc::test {

/// How many files of each kind: CAPSOC_FUZZ_FILES, else `usual`.
inline uint64_t file_count(uint64_t usual) {
  const char* asked = std::getenv("CAPSOC_FUZZ_FILES");
  return asked != nullptr ? std::strtoull(asked, nullptr, 10) : usual;
}

class Damage {
 public:
  explicit Damage(uint64_t number) : random_(number, 99) {}

  uint64_t below(uint64_t limit) { return limit != 0 ? random_.word(draw_++) % limit : 0; }

  /// Changes, inserts, removes or repeats characters in up to eight places, mostly ones that mean
  /// something to one of the formats.
  std::string text(std::string whole) {
    static const std::string likely = "0123456789.,-+eE\n\r\t \"'[]{}=#:_naifAF";
    // A letter, spaces, a combining mark, a byte order mark, a surrogate, beyond the 16-bit plane.
    static constexpr const char* beyond_ascii[] = {
        "\u00e9", "\u00a0", "\u2003", "\u0301", "\ufeff", "\u2028", "\xed\xa0\x80", "\U0001f600"};
    for (uint64_t edits = 1 + below(8); edits > 0 && !whole.empty(); --edits) {
      const std::size_t place = below(whole.size());
      if (below(16) == 0) whole.insert(place, beyond_ascii[below(std::size(beyond_ascii))]);
      const char byte =
          below(4) != 0 ? likely[below(likely.size())] : static_cast<char>(below(256));
      switch (below(4)) {
        case 0:
          whole[place] = byte;
          break;
        case 1:
          whole.insert(place, 1, byte);
          break;
        case 2:
          whole.erase(place, 1 + below(20));
          break;
        default:
          whole.insert(place, whole.substr(below(whole.size()), 1 + below(40)));
      }
    }
    return whole;
  }

  /// Changes up to six words, bytes and bits, half of them in the first `header` or the last
  /// `trailer` bytes; cuts one file in eight short.
  std::string binary(std::string whole, std::size_t header, std::size_t trailer) {
    static constexpr uint32_t odd[] = {0,          1,          0xFFFFFFFF, 0x7FFFFFFF,
                                       0x80000000, 0xFFFFFFF0, 0x20000000, 0x1000};
    for (uint64_t edits = 1 + below(6); edits > 0; --edits) {
      std::size_t place = below(whole.size() - 4);
      if (below(2) != 0)
        place = below(2) != 0 ? below(header) : whole.size() - 4 - below(trailer - 4);
      if (below(2) != 0) {
        const uint32_t word =
            below(2) != 0 ? odd[below(8)] : static_cast<uint32_t>(below(uint64_t{1} << 32U));
        for (unsigned i = 0; i < 4; ++i)
          whole[place + i] = static_cast<char>(word >> (8 * i) & 0xFF);
      } else {
        whole[place] = static_cast<char>(below(256));
      }
    }
    if (below(8) == 0) whole.resize(below(whole.size()));
    return whole;
  }

 private:
  RandomSequence random_;
  uint64_t draw_ = 0;
};

}  // namespace capsoc::test
