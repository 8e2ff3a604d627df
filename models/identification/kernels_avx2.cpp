// kernels.h for processors with AVX2 (compiled with -mavx2): four doubles at a time.
#include <immintrin.h>

namespace capsoc::identification {
namespace {

using Part = __m256d;
constexpr int parts = 2;
inline Part splat_part(double value) {
  return _mm256_set1_pd(value);
}
inline Part root_part(Part value) {
  return _mm256_sqrt_pd(value);
}
inline Part least_part(Part a, Part b) {
  return _mm256_min_pd(a, b);
}
inline Part largest_part(Part a, Part b) {
  return _mm256_max_pd(a, b);
}

}  // namespace
}  // namespace capsoc::identification

#include "identification/kernels_body.h"

const capsoc::identification::Kernels capsoc::identification::kernels_avx2 =
    capsoc::identification::all;
