// What a run in a session says at its end.
#pragma once

#include "base/result.h"
#include "service/message.h"

namespace capsoc::cli {

/// The exit code of a run that was ended before it began.
int code_of_refusal();

/// Shows what service::run_in_session() answered, on standard error. Returns the exit code. A
/// signal that came is the end that `answer` then has.
int tell_end(service::Json& answer);

}  // namespace capsoc::cli
