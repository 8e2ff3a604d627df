#include "service/signals.h"

#include "base/constants.h"

namespace capsoc::service {

Json coprocessor_signals(const metrics::RecordedResult& result) {
  const metrics::Parameters found = metrics::to_values(result.words);
  constexpr double degrees = 180 / pi, degrees_of_turn = 360;
  return {{"a1", found.a1},
          {"a2", found.a2},
          {"b1", found.b1},
          {"b2", found.b2},
          {"beta_deg", found.beta * degrees},
          {"phi_deg", found.phi * degrees},
          {"angle_deg", result.angle / q32 * degrees_of_turn},
          {"angle_valid", result.angle_valid},
          {"error_u", result.error_u / q31},
          {"error_v", result.error_v / q31},
          {"error_average", result.error_average / q31},
          {"status", result.status},
          {"flags", result.flags}};
}

}  // namespace capsoc::service
