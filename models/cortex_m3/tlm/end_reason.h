#pragma once

namespace capsoc::cortex_m3 {

/// Why the processor ended the simulation.
enum class EndReason { none, exit, lockup, stuck, asleep, end_on_idle, interrupted, debugger };

}  // namespace capsoc::cortex_m3
