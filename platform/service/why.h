// Why a signal of the coprocessor has its value: which values made it, back to the sample and the
// registers (coprocessor/signal_flow.h).
#pragma once

#include <string>

#include "service/board.h"
#include "service/message.h"
#include "service/verb.h"

namespace capsoc::service {

/// Of the next result of the coprocessor, for a board that stands right after the one before. The
/// board advances to that result and is used for nothing else. {"sample", "position", "steps",
/// "inputs"} as history.why has them. An Error: there is no such signal, or no result comes.
Answer explain_next_result(Board& board, const std::string& signal);

}  // namespace capsoc::service
