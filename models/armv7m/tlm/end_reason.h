#pragma once

namespace capsoc::armv7m {

/// Why the processor ended the simulation.
enum class EndReason { none, exit, lockup, stuck, asleep, end_on_idle, interrupted, debugger };

}  // namespace capsoc::armv7m
