// Unwinding without debug information, by the instructions at a function's beginning.
#pragma once

#include "source/registers.h"

namespace capsoc::source {

/// Unwinds from a frame to its caller's, for a function that begins at `function`. Undoes what the
/// function has pushed and reserved up to `address`: PUSH, STMDB, SUB SP, a frame pointer in r7 or
/// r11. This is a guess: an epilogue, or a stack pointer that moves in the middle of a function,
/// misleads it. False, with nothing changed, if the stack cannot be read.
bool unwind_by_prologue(uint32_t function, uint32_t address, Registers& registers,
                        const ReadWord& read);

}  // namespace capsoc::source
