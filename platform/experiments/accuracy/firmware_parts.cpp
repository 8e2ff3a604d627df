#include "accuracy/firmware_parts.h"

extern "C" {
// NOLINTBEGIN(bugprone-suspicious-include): sources of another target, which has no library here
#include "apps/common/start_range.c"
#include "apps/follow/follower.c"
// NOLINTEND(bugprone-suspicious-include)
}
