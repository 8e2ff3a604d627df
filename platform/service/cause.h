// Who did that: what happened to a register, a variable or a device between two instants of a
// history. In a board that is used for nothing else.
#pragma once

#include <string>

#include "service/board.h"
#include "service/message.h"
#include "service/verb.h"

namespace capsoc::service {

/// What the instruction did that is executed next, to memory or to a register of the processor:
/// {"pc", "place", "old", "new", "position"}, of memory as lists of bytes. Executes it.
Answer describe_write(Board& board, const Json& what);

/// Instants where a simulation was, of a register of a device: the last one with its old value and
/// the first one with its new value.
struct Change {
  std::string name;
  Position since, end;
};

/// Who made it, for a board that stands a little before. {"by": the method of a request}. Or, if an
/// instruction accessed the device, {"by": "instruction", "pc", "place", "access": "write" or
/// "read", "accessed": the register, or the address if it is none}. Otherwise {"by": "device"},
/// with "sample" if the coprocessor had a result. Goes to the end.
Answer describe(Board& board, const Change& change);

}  // namespace capsoc::service
