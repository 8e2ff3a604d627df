#pragma once

#include "metrics/sample_record.h"
#include "service/message.h"

namespace capsoc::service {

/// What coprocessor.read has of a result: a1, a2, b1, b2, error_u, error_v, error_average (full
/// scale), beta_deg, phi_deg, angle_deg, angle_valid, status, flags.
Json coprocessor_signals(const metrics::RecordedResult& result);

}  // namespace capsoc::service
