#include "accuracy/firmware_parts.h"

extern "C" {
#include "apps/common/start_range.c"
#include "apps/follow/follower.c"
}
