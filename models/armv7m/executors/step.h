#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "armv7m/isa/op.h"

namespace capsoc::armv7m {

class Machine;
struct Step;

/// Executes one operation. True: continue with the next one in memory. False: the program counter
/// has been set, or an event is to be handled, and the block is left.
using Handler = bool (*)(Machine&, const Step&);

/// Executes an operation and those after it, by jumps from one to the next, to the end of their
/// block and accounts for it. Returns the first step of the block to continue with, or null for the
/// run loop to decide.
using Chain = const Step* (*)(Machine&, const Step*);

/// The two forms of one operation's semantics.
struct Executors {
  Handler one;
  Chain chain;
};

/// A decoded operation as the executors hold it. A block is an array of them: a run of operations
/// from one address, inside one page, closed by a step that leaves it. It fills a cache line.
struct Step : DecodedOp {
  Chain chain = nullptr;               // may leave out flags that are never seen, or do two steps
  const Executors* body = nullptr;     // after the condition
  mutable const Step* link = nullptr;  // first step of the block a branch within the page leads to
  uint16_t cycles_before = 0;          // of the operations before it in its block
  uint16_t instructions_to = 0;        // instructions up to and including this one
  uint16_t block_cycles = 0;           // of a block's first step: bound on it and the way to it
  uint16_t trail = 0;                  // timing::Trail it leaves
};
static_assert(sizeof(Step) == 64);

/// What closes a block: it leaves for the address after the last operation.
Step closing_step(const Step& last);

/// The blocks of one page, by the halfword they start at, and which of its lines hold code. Links
/// join blocks of one page only, so they go when the page's code goes, all at once.
struct CodePage {
  std::array<std::unique_ptr<Step[]>, 2048> blocks;
  uint64_t code_lines = 0;  // bit n: bytes 64n..64n+63 were decoded
  // The same of bytes that are not stored to directly for another reason: they are read-only, or a
  // listener is notified of stores there.
  uint64_t closed_lines = 0;
  // Of the translator: the host code of a block, by the halfword it starts at, and how often it was
  // executed without.
  std::array<const void*, 2048> entries{};
  std::array<uint8_t, 2048> heat{};
};

}  // namespace capsoc::armv7m
