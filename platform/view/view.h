// A run that a browser shows and steers (docs/guide/view.md).
#pragma once

#include <string>

#include "base/result.h"
#include "service/message.h"
#include "session/run_settings.h"
#include "view/choices.h"
#include "view/story.h"

namespace capsoc::view {

/// Runs what the settings say in its own session, under the pages at view.port, whose address
/// is printed on standard error. It begins when a page is open, at the speed of run.realtime, and
/// ends when a page or a signal ends it. The answer of simulation.finish; errors as
/// service::run_in_session(). Before this process has a thread.
/// `choices`: of further runs, which pages can begin in the place of this one; null: of none.
/// `story`: told on the pages, and its settings are among these; null: none.
Result<service::Json> run_in_view(const run::RunSettings& settings, const Choices* choices,
                                  const Story* story);
/// The same of a session file, which is repeated; the settings come over its own.
Result<service::Json> replay_in_view(const run::RunSettings& settings, const std::string& recorded);

}  // namespace capsoc::view
