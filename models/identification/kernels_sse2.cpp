// kernels.h for every x86-64: two doubles at a time.
#include <immintrin.h>

namespace capsoc::identification {
namespace {

using Part = __m128d;
constexpr int parts = 4;
inline Part splat_part(double value) {
  return _mm_set1_pd(value);
}
inline Part root_part(Part value) {
  return _mm_sqrt_pd(value);
}
inline Part least_part(Part a, Part b) {
  return _mm_min_pd(a, b);
}
inline Part largest_part(Part a, Part b) {
  return _mm_max_pd(a, b);
}

}  // namespace
}  // namespace capsoc::identification

#include "identification/kernels_body.h"

const capsoc::identification::Kernels capsoc::identification::kernels_sse2 =
    capsoc::identification::all;
