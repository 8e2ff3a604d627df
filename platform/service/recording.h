// A session recorded, and replayed.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "host/temporary_folder.h"
#include "service/board.h"
#include "service/part_traces.h"
#include "service/session_file.h"

namespace capsoc::service {

/// All that happened until now, from the beginning of the history on; with `last_s`, simulated
/// seconds, from its last snapshot that is at least as long ago. An Error: there is no history, or
/// an input file cannot be read.
Result<SessionFile> record(Board& board, std::optional<double> last_s);

/// A recorded session, laid out for a simulation that repeats it.
struct Repetition {
  std::shared_ptr<host::TemporaryFolder> folder;  ///< of its files; has to outlive the simulation
  Json settings = Json::object();
  std::string state = "";  ///< where it begins, as Board::Snapshot::to_bytes(); "": out of reset
  std::vector<Input> inputs = {};
  Position end = {};
};
/// An Error: it has settings or inputs that no recorded one has, or there is no room for its files.
Result<Repetition> lay_out(const SessionFile& session);
/// A file that record() gave. An Error names it.
Result<SessionFile> read_session(const std::string& file);

/// Where it begins; its inputs are to be expected. `writes_in`, and an Error, as Board::construct()
/// has them.
Result<std::unique_ptr<Board>> construct(const Repetition& laid, const std::string& writes_in = "");

/// What a replay shows.
struct Replayed {
  uint64_t inputs = 0, marks = 0;  ///< that were applied, and that were compared
  double end_s = 0;                ///< simulated
  std::string difference;          ///< a sentence with the first one; "": there is none
  std::vector<std::string> lost;   ///< a sentence for each trace that is not whole
};

/// Simulates a session again and compares, with these traces up to the end or the first
/// difference. `until_s`: only so far. `on_text` gets what UART 0 sends. The only simulation of its
/// process. An Error: it cannot be built, has an input that is none, or a trace cannot be written.
Result<Replayed> replay(const SessionFile& session, std::optional<double> until_s,
                        const PartTraceSettings& wanted,
                        const std::function<void(const std::string& text)>& on_text);

}  // namespace capsoc::service
