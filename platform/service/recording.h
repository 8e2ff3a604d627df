// A session recorded, and replayed.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "base/result.h"
#include "service/board.h"
#include "service/session_file.h"

namespace capsoc::service {

/// All that happened until now. An Error: there is no history, or its beginning is gone, or an
/// input file cannot be read.
Result<SessionFile> record(Board& board);

/// What a replay shows.
struct Replayed {
  uint64_t inputs = 0, marks = 0;  ///< that were applied, and that were compared
  double end_s = 0;                ///< simulated
  std::string difference;          ///< a sentence with the first one; "": there is none
};

/// Simulates a session again and compares. `until_s`: only so far. `on_text` gets what UART 0
/// sends. The only simulation of its process. An Error: it cannot be built, or has an input that is
/// none.
Result<Replayed> replay(const SessionFile& session, std::optional<double> until_s,
                        const std::function<void(const std::string& text)>& on_text);

}  // namespace capsoc::service
