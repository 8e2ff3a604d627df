// A run of the command line in a session: with a debugger that can go back, or recorded.
#pragma once

#include "base/result.h"
#include "service/message.h"
#include "session/run_settings.h"

namespace capsoc::service {

/// Runs what the settings say in its own session, under the debuggers that connect to
/// gdb.port, if there is one; the session is written to results.session, if that is given. What the
/// program says on standard streams goes there, once, however often the past is simulated again.
/// The answer of simulation.finish. An Error: a wrong input, or settings that allow no history;
/// nothing was simulated. Before this process has a thread.
/// `recorded`: a session file to repeat, whose settings these come over; "": none.
Result<Json> run_in_session(const run::RunSettings& settings, const std::string& recorded = "");

}  // namespace capsoc::service
