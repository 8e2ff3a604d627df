// Unwinding without debug information, by the instructions at a function's beginning.
#pragma once

#include "source/registers.h"

namespace capsoc::source {

/// From a frame to its caller's, for a function that begins at `function`: what it has pushed and
/// reserved on its way to `address` is given back (PUSH, STMDB, SUB SP, a frame pointer in r7 or
/// r11). A guess: an epilogue, or a stack that is moved in the midst of a function, misleads it.
/// False, and nothing changed, where the stack cannot be read.
bool unwind_by_prologue(uint32_t function, uint32_t address, Registers& registers,
                        const ReadWord& read);

}  // namespace capsoc::source
