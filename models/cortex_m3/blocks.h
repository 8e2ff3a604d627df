#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "cortex_m3/op.h"

namespace capsoc::cortex_m3 {

class Core;
struct Step;

/// Executes one operation. True: go on with the next one in memory. False: the program counter has
/// been set, or an event is to be handled, and the block is left.
using Handler = bool (*)(Core&, const Step&);

/// A decoded operation as the executors hold it.
struct Step : DecodedOp {
  Handler handler = nullptr;
  Handler body = nullptr;        // behind a condition
  uint16_t cycles_before = 0;    // of the operations before it in its block
  uint16_t instructions_to = 0;  // instructions up to and including this one
};

/// A run of operations from one address, inside one page, closed by a step that leaves it.
struct Block {
  std::vector<Step> steps;
  uint32_t most_cycles = 0;  // bound on the cycles before the last operation begins, plus its own
};

/// The blocks of one page, by the halfword they start at, and which of its lines hold code.
struct CodePage {
  std::array<std::unique_ptr<Block>, 2048> blocks;
  uint64_t code_lines = 0;  // bit n: bytes 64n..64n+63 were decoded
};

}  // namespace capsoc::cortex_m3
