// The identifier as one function: samples in, parameters with intervals, checks and reasons out.
#pragma once

#include "base/result.h"
#include "identification/identification.h"
#include "identification/samples.h"

namespace capsoc::identification {

/// Identifies a1, a2, b1, b2 and beta, Eq (3) of the CSFN paper, from samples without their angles.
/// The same samples and options give the same digits on every run and at every vector width. Error:
/// options out of range. Bad data is no error: see Identification::rejection().
Result<Identification> identify(const Samples& samples, const IdentifyOptions& options = {});

}  // namespace capsoc::identification
