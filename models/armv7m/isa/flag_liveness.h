#pragma once

#include <cstdint>
#include <vector>

#include "armv7m/isa/op.h"

namespace capsoc::armv7m {

/// The condition flags as a set: a bit each, N and Z together.
namespace flag {
enum Bit : uint8_t { nz = 1, c = 2, v = 4, all = 7 };
}  // namespace flag

/// What one operation does to the flags, as sets of flag::Bit. As constructed: an operation of
/// which nothing is known.
struct FlagUse {
  uint8_t reads = flag::all;
  uint8_t sets = 0;   ///< may get another value
  uint8_t kills = 0;  ///< get a value that does not depend on their old one, in every case.
  /// Execution may leave the block at the operation, in front of it or after it, so that all flags
  /// can be seen there.
  bool exits = true;
};

/// What an operation does to the flags under its condition: it reads the flags of the condition as
/// well, and kills none. Derived from the third column of operations.def. Valid for the defined
/// form of the encoding: the caller must treat an UNPREDICTABLE form as an exit if its executor
/// does anything else.
FlagUse flag_use(const DecodedOp& op);
/// The same, given that the condition is met.
FlagUse flag_use_if_executed(const DecodedOp& op);
/// The flags that a condition of the architecture (A7.3.1, 0 to 13) reads.
uint8_t flags_of_condition(unsigned condition);
/// True if dropping the S bit of an operation removes its flags and nothing else, and the form
/// without is its own operation.
bool has_form_without_flags(const DecodedOp& op);

/// Liveness, backwards over the operations of a block: for each, the flags that may be read after
/// it, or seen where execution may leave the block, before they are set again. All are live at the
/// end. `op_at(i)` is operation i; `may_be_left_at(i)` adds exits of the executor's own.
template <typename OpAt, typename MayBeLeftAt>
std::vector<uint8_t> live_flags(std::size_t count, const OpAt& op_at,
                                const MayBeLeftAt& may_be_left_at) {
  std::vector<uint8_t> live_behind(count, flag::all);
  uint8_t live = flag::all;
  for (std::size_t i = count; i-- > 0;) {
    live_behind[i] = live;
    const FlagUse use = flag_use(op_at(i));
    live = static_cast<uint8_t>((live & ~use.kills) | use.reads);
    if (use.exits || may_be_left_at(i)) live = flag::all;
  }
  return live_behind;
}

}  // namespace capsoc::armv7m
