// Where a simulation is in its history. What goes back is the session's affair
// (session_history.cpp).
#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <utility>
#include <vector>

#include "host/child_process.h"
#include "host/descriptor.h"
#include "host/file_uses.h"
#include "host/files.h"
#include "host/sha256.h"
#include "service/board_verbs.h"
#include "service/recording.h"
#include "session/run_files.h"

namespace capsoc::service {
namespace {

Answer when(Board& board, const Call& call) {
  Answer answer;
  answer.result["now"] = to_json(board.position());
  const History& history = board.history();
  answer.result["kept"] = history.is_on();
  if (history.is_on()) {
    answer.result["beginning"] = to_json(history.beginning());
    answer.result["end"] = to_json(history.end());
    answer.result["inputs"] = history.inputs().size();
    answer.result["snapshots"] = history.snapshots().size();
    answer.result["bytes"] = history.bytes();
  } else {
    answer.result["why"] = board.no_history();
  }
  if (!call.has("hash") || !call.boolean("hash")) return answer;
  const auto state = board.simulation().packed_state();
  if (!state) return refuse(state.error());
  answer.result["sha256"] = host::sha256_of(state.value());
  return answer;
}

Answer keep(Board& board, const Call&) {
  if (!board.history().is_on()) return refuse("there is no history: " + board.no_history());
  if (auto error = board.keep()) return refuse(error->text);
  return {};
}

/// In a process that ends with the run, so that this one can continue.
Answer outcome(Board& board, const Call&) {
  if (!board.history().is_on())
    return refuse("simulation.outcome: there is no history: " + board.no_history());
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return refuse("there are no more files to be had");
  const host::Descriptor said(ends[0]);
  host::Descriptor says(ends[1]);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) return refuse("simulation.outcome: no process can be started");
  if (child == 0) {
    host::end_with_parent(parent, 1);
    spdlog::set_level(spdlog::level::off);
    const Message finished{board.finish(), {}};
    _exit(host::write_all(says.get(), to_bytes(finished)) ? 0 : 1);
  }
  says.reset();
  MessageReader reader;
  char buffer[65536];
  for (ssize_t count = 1; count != 0;) {
    count = ::read(said.get(), buffer, sizeof buffer);
    if (count > 0) reader.feed({buffer, static_cast<std::size_t>(count)});
    if (count < 0 && errno != EINTR) break;
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  auto incoming = reader.next();
  if (!incoming || !incoming->message) return refuse("simulation.outcome: its process crashed");
  Answer answer;
  answer.result = std::move(incoming->message->body);
  return answer;
}

Answer write_session(Board& board, const Call& call) {
  const std::string file = call.text("file");
  const auto session = record(board);
  if (!session) return refuse("simulation.record: " + session.error());
  std::vector<host::FileUse> uses = run::files_of(board.settings());
  uses.push_back({host::FileUse::Kind::output, "simulation.record", file});
  if (auto error = host::check_uses(uses)) return refuse(error->text);
  const std::string bytes = pack(session.value());
  if (bytes.size() > SessionFile::largest)
    return refuse("simulation.record: the session has more than 1 GiB; record a shorter one");
  if (auto error = host::write_whole(file, bytes)) return refuse(error->text);
  Answer answer;
  answer.result = {{"bytes", bytes.size()},
                   {"inputs", session.value().inputs.size()},
                   {"marks", session.value().marks.size()}};
  return answer;
}

}  // namespace

std::vector<BoardVerb> history_verbs() {
  return {
      {{"history.when",
        "Where the simulation is in its history. A position has time_s, time_ps, cycles, "
        "instructions and samples.",
        {may("hash", Type::boolean, "with the hash of the whole state")},
        {{"now", "object", "the position of the simulation"},
         {"kept", "boolean", "whether there is a history"},
         {"why", "text", "there is none"},
         {"beginning", "object", "the first position that can be reached"},
         {"end", "object", "the last one that was reached"},
         {"inputs", "integer", "requests that changed the simulation, since the beginning"},
         {"snapshots", "integer", "kept to go back to"},
         {"bytes", "integer", "that inputs and snapshots take; history_mb limits them"},
         {"sha256", "text", "of the state, equal for equal states of one program and settings"}}},
       when,
       Effect::looks},
      {{"history.keep",
        "Keeps a snapshot of now in the history, from where later positions are reached quickly. "
        "Some are kept without it.",
        {},
        {}},
       keep,
       Effect::looks},
      {{"simulation.outcome",
        "What simulation.finish would answer here. Nothing ends, and the simulation can continue "
        "or go back; it has to have a history.",
        {},
        {{"code", "integer", "the exit code of `capsoc run`"},
         {"reason", "text", "why it ended; of a run that is not over, as if it ended here"},
         {"reports", "list", "of a crash, or a difference between model and RTL"},
         {"lost", "list", "a sentence for each output that is not whole"},
         {"table", "text", "what `capsoc run` prints at its end"},
         {"result", "object", "as `capsoc run --json` writes it (docs/reference/results.md)"}}},
       outcome,
       Effect::looks},
      {{"simulation.record",
        "Writes the session of this simulation until now to a file that `capsoc replay` simulates "
        "again. It has settings, the program and the sensor by content, every request that changed "
        "the "
        "simulation with its instant, and hashes of the state on the way and at the end.",
        {need("file", Type::text, "its path")},
        {{"bytes", "integer", "of the file"},
         {"inputs", "integer", "requests in it"},
         {"marks", "integer", "positions whose state a replay compares"}}},
       write_session,
       Effect::looks},
  };
}

}  // namespace capsoc::service
