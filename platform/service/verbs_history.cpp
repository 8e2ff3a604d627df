// Where a simulation is in its history. What goes back is the session's affair
// (session_history.cpp).
#include "host/sha256.h"
#include "service/board_verbs.h"

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
       when},
      {{"history.keep",
        "Keeps a snapshot of now in the history, from where later positions are reached quickly. "
        "Some are kept without it.",
        {},
        {}},
       keep},
  };
}

}  // namespace capsoc::service
