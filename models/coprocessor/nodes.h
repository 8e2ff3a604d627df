// The nodes of one sample (coprocessor/nodes.def lists them), for lockstep's comparison and waves.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace capsoc {
class Archive;
}

namespace capsoc::coprocessor {

// Raw words: signed formats sign-extended, unsigned ones zero-extended.
struct Nodes {
#define NODE(name, stage, unit, format, model, when, rtl) int64_t name = 0;
#include "coprocessor/nodes.def"

  // Results committed since the last reset of either kind. No node, never compared.
  uint64_t commits = 0;
  // The edge at which submit() latched this sample; 0: software wrote it. No node.
  uint64_t taken = 0;
  // Whose sample it was. No node, and no state: it is looked at when the result is committed.
  unsigned channel = 0;

  void visit(Archive& archive);
};

// Where a node comes into being: 0 to 4 for T0 to T4, `commit_stage` for the registers.
inline constexpr unsigned commit_stage = 5;

enum class NodeIndex : std::size_t {
#define NODE(name, stage, unit, format, model, when, rtl) name,
#include "coprocessor/nodes.def"
  count
};
inline constexpr auto node_count = static_cast<std::size_t>(NodeIndex::count);

enum class Meaning : uint8_t {
  word,    // a flag, a counter, a part of a wider number
  number,  // fixed point
  turns,   // an angle or an angular speed in turns
};

// A section of docs/reference/coprocessor.md, which makes the node.
enum class Unit : uint8_t {
  calibrator,
  polar_unit,
  reference_generator,
  lms_demodulator,
  turn_judge,
  register_bank,
};
// As reports print it: "LMS demodulator".
const char* name_of(Unit unit);

struct NodeFormat {
  unsigned width = 64;  // bits of the word, 1 to 64
  bool is_signed = false;
  unsigned fraction = 0;  // fraction bits
  Meaning meaning = Meaning::word;

  // The value of a word as Nodes has it: a number, or degrees.
  double value(int64_t word) const;
  // Whether it is one as Nodes has it: bits above the width are copies of the sign, or 0.
  bool fits(int64_t word) const;
};

struct NamedNode {
  const char* name;
  unsigned stage;
  Unit unit;
  int64_t Nodes::*value;
  NodeFormat format;
};
// Every node of Nodes by name, in pipeline order.
const std::array<NamedNode, node_count>& node_names();

}  // namespace capsoc::coprocessor
