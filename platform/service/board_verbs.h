// The methods of one simulation, by subject.
#pragma once

#include <functional>
#include <vector>

#include "service/board.h"
#include "service/verb.h"

namespace capsoc::service {

struct BoardVerb {
  Declaration about;
  std::function<Answer(Board& board, const Call& call)> perform;
  bool after_the_end = false;  ///< may be asked of a finished simulation
};

std::vector<BoardVerb> advance_verbs();
std::vector<BoardVerb> memory_verbs();
std::vector<BoardVerb> register_verbs();
std::vector<BoardVerb> port_verbs();
std::vector<BoardVerb> sensor_verbs();

/// All of them, in the order of the reference.
const std::vector<BoardVerb>& board_verbs();

}  // namespace capsoc::service
