#pragma once

#include <cstdint>
#include <memory>

#include "armv7m/executors/step.h"

namespace capsoc::armv7m {

/// Makes the blocks that chains of steps come to first.
class BlockBuilder {
 public:
  /// The block at an address of a page that may be executed, closed by a step; null where there can
  /// be none. The lines that it was decoded from are noted in the page.
  virtual std::unique_ptr<Step[]> build(uint32_t address, CodePage& page) const = 0;

 protected:
  ~BlockBuilder() = default;
};

}  // namespace capsoc::armv7m
