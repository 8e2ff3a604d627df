// What a debugger lets the processor stop at, as messages have it.
#pragma once

#include <optional>

#include "base/result.h"
#include "debug/target.h"
#include "service/board.h"
#include "service/message.h"

namespace capsoc::service {

/// The points of a request, a list of {"kind", "address", "size"}, are set on the board from here
/// on. An Error: one of them is none, or cannot be watched.
std::optional<Error> set_points(Board& board, const Json& points);
void clear_points(Board& board, const Json& points);

/// {"reason", "point", "address"}; cause_in() takes it apart again.
Json to_json(const debug::StopCause& cause);
debug::StopCause cause_in(const Json& about);
/// The name of a kind of point in a message.
const char* name_of(debug::StopPoint point);

}  // namespace capsoc::service
