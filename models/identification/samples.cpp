#include "identification/samples.h"

#include "identification/moments.h"

namespace capsoc::identification {

std::optional<Error> check_samples(const Channel& u, const Channel& v) {
  const Result<Moments> moments = moments_of(u, v);
  if (moments) return std::nullopt;
  return Error{moments.error()};
}

}  // namespace capsoc::identification
