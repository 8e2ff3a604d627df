// What the RTL's registers and the model's state say of one another while the pipeline is empty.
#pragma once

#include "coprocessor/idle_state.h"
#include "rtl/rtl_abi.h"

namespace capsoc::rtl {

/// Registers of an RTL that comes from reset, with which it continues as the model does from
/// `state`. Its slot 0 has the last result and its bank 0 the window under way, as after a reset.
capsoc_rtl_state to_rtl(const coprocessor::IdleState& state);

/// The other way. `nodes` are those of the last result, which know some words better than the
/// registers. Cycle 0.
coprocessor::IdleState to_model(const capsoc_rtl_state& registers, const coprocessor::Nodes& nodes);

}  // namespace capsoc::rtl
