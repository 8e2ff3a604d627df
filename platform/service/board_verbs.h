// The methods of one simulation, by subject.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "service/board.h"
#include "service/verb.h"

namespace capsoc::service {

/// What a method has to do with the simulation. Each one says it: an input that is not logged would
/// be missing when the past is simulated again.
enum class Effect {
  looks,                ///< changes nothing in it, or is no input (simulation.advance)
  looks_after_the_end,  ///< likewise, and may be asked of a finished simulation
  input,                ///< changes it: it is logged in the history
};

struct BoardVerb {
  Declaration about;
  std::function<Answer(Board& board, const Call& call)> perform;
  Effect effect;
};

std::vector<BoardVerb> activity_verbs();
std::vector<BoardVerb> advance_verbs();
std::vector<BoardVerb> memory_verbs();
std::vector<BoardVerb> register_verbs();
std::vector<BoardVerb> port_verbs();
std::vector<BoardVerb> sensor_verbs();
std::vector<BoardVerb> fault_verbs();
std::vector<BoardVerb> history_verbs();
std::vector<BoardVerb> debugger_verbs();

/// All of them, in the order of the reference.
const std::vector<BoardVerb>& board_verbs();
/// Null: there is none of that name.
const BoardVerb* board_verb(const std::string& method);

/// Performs one that changes the simulation.
Answer perform_input(Board& board, const BoardVerb& verb, const Call& call);
/// Performs a logged request again. An Error: there is no such method, or its parameters are
/// wrong; a request that was refused when it was logged is refused again, which is none.
std::optional<Error> apply_input(Board& board, const Input& input);

}  // namespace capsoc::service
