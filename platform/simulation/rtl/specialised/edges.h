// Edges of the Verilated coprocessor that are compiled for one state of its sequencer each;
// README.md here says how they are made. For the library that holds the design.
#pragma once

#include "coprocessor/sequencer.h"

class Vcoprocessor_probe___024root;

namespace capsoc::rtl {

using SpecialisedEdge = void (*)(Vcoprocessor_probe___024root*);

/// First index of the tables; the second is the cycle of the tick. All without a reset, a LOAD and
/// a bus access.
enum SpecialisedState : unsigned {
  stage_0_alone =
      0,  ///< and those after it: one sample in the pipeline, in this stage; none waits or comes
  held_alone = coprocessor::stage_count,  ///< one sample, in the holding register; cycle 0 only, as
                                          ///< those below
  sample_alone,                           ///< one sample, on the pins
  nothing_at_all,
  other_state
};
inline constexpr unsigned specialised_states = other_state;  // rows of the tables

/// A rising and a falling edge. Registers, those of the probe included, are then what evaluating
/// the design makes of them; combinational variables and outputs are as before. Null: none.
extern const SpecialisedEdge specialised_edges[specialised_states][coprocessor::tick_cycles];
/// The outputs, from the registers; nothing else changes.
extern const SpecialisedEdge specialised_outputs[specialised_states][coprocessor::tick_cycles];

/// The outputs in any state, if has_outputs.
void outputs(Vcoprocessor_probe___024root*);
extern const bool has_outputs;

}  // namespace capsoc::rtl
