// The options of a coprocessor of several channels.
#pragma once

#include "coprocessor/types.h"

namespace capsoc::coprocessor {

inline Options with_channels(unsigned count, Arithmetic arithmetic = Arithmetic::precise) {
  Options options;
  options.channels = static_cast<int>(count);
  options.arithmetic = arithmetic;
  return options;
}

}  // namespace capsoc::coprocessor
