#pragma once

#include <cstdint>

#include "armv7m/executors/step.h"

namespace capsoc::armv7m {

/// A way out of translated code, back to C++.
struct BlockExit {
  enum class Kind : uint8_t {
    step,      ///< continues with a step, decoded; its block's cycles so far are not counted yet
    edge,      ///< between two blocks: continues at `pc`
    indirect,  ///< ditto, at State::pc
  };
  static constexpr uint32_t no_slot = ~0u;

  Kind kind = Kind::step;
  uint16_t trail = 0;  ///< timing::Trail after an edge
  uint16_t bound = 0;  ///< Step::block_cycles of the step's block
  const Step* step = nullptr;
  uint32_t pc = 0;
  uint32_t recipe = 0;      ///< of the flags that are not in the state
  uint32_t slot = no_slot;  ///< where in the code buffer the edge's jump finds its target
};

}  // namespace capsoc::armv7m
