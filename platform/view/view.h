// A run that a browser shows and steers (docs/guide/view.md).
#pragma once

#include <string>

#include "base/result.h"
#include "service/message.h"
#include "session/run_settings.h"
#include "view/story.h"

namespace capsoc::view {

/// Runs what the settings say in its own session, under the pages at view.port, whose address
/// is printed on standard error. It begins when a page is open, at the speed of run.realtime, and
/// ends when a page or a signal ends it. The answer of simulation.finish; errors as
/// service::run_in_session(). Before this process has a thread.
/// `recorded`: a session file to repeat, whose settings these come over; "": none. `story`: told on
/// the pages, and its settings are among these; null: none.
Result<service::Json> run_in_view(const run::RunSettings& settings,
                                  const std::string& recorded = "", const Story* story = nullptr);

}  // namespace capsoc::view
