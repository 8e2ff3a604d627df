// What the words of the coprocessor's nodes mean (docs/coprocessor.md has the formats).
#pragma once

#include <cstdint>
#include <string_view>

namespace capsoc::trace {

enum class Meaning : uint8_t {
  word,    ///< a flag, a counter, a part of a wider number
  number,  ///< fixed point
  turns,   ///< an angle or an angular speed in turns
};

struct NodeFormat {
  unsigned width = 32;  ///< bits of the word
  bool is_signed = false;
  unsigned fraction = 0;  ///< fraction bits
  Meaning meaning = Meaning::word;

  /// The value of a word as coprocessor::Nodes has it: a number, or degrees.
  double value(int64_t word) const;
};

/// The format of a node of coprocessor::Nodes; a 64-bit word for a name that is none.
NodeFormat node_format(std::string_view name);

}  // namespace capsoc::trace
