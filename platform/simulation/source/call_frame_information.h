// Unwinding by what the compiler says of its frames (.debug_frame).
#pragma once

#include <elfutils/libdw.h>

#include "source/registers.h"

namespace capsoc::source {

enum class Unwound {
  caller,        ///< the registers are the caller's
  outermost,     ///< there is none: the return address is undefined
  not_described  ///< nothing is said of this address, or it cannot be read
};

/// From a frame to its caller's. `address`: an instruction of the frame, for a caller one inside
/// its call. Changes nothing unless the result is `caller`.
Unwound unwind_by_description(Dwarf_CFI* frames, uint32_t address, Registers& registers,
                              const ReadWord& read);

}  // namespace capsoc::source
