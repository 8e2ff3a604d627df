// The files that a simulation writes, as its settings name them.
#pragma once

#include <vector>

#include "host/file_uses.h"
#include "service/message.h"

namespace capsoc::service {

/// Of settings as simulation.construct has them. None of settings that are refused, and none that
/// no setting names: the waves of a difference in lockstep. Of more than 16 KiB of settings none,
/// and no more than a hundred.
std::vector<host::FileUse> outputs_of(const Json& settings);

}  // namespace capsoc::service
