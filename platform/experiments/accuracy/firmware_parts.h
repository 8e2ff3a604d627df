// What the program `follow` decides by, compiled for the host from the firmware's own sources.
#pragma once

extern "C" {
#include "apps/common/start_range.h"
#include "apps/follow/follower.h"
}
