#include "csfn/samples.h"

#include "csfn/moments.h"

namespace capsoc::csfn {

std::optional<Error> check_samples(const Channel& u, const Channel& v) {
  const Result<Moments> moments = moments_of(u, v);
  if (moments) return std::nullopt;
  return Error{moments.error()};
}

}  // namespace capsoc::csfn
