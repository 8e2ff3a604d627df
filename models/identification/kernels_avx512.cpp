// kernels.h for processors with AVX-512F (compiled with -mavx512f): eight doubles at a time.
#include <immintrin.h>

namespace capsoc::identification {
namespace {

using Part = __m512d;
constexpr int parts = 1;
inline Part splat_part(double value) {
  return _mm512_set1_pd(value);
}
// With a full mask, because GCC 12 warns about the undefined value inside the plain forms.
constexpr __mmask8 every = 0xFF;
inline Part root_part(Part value) {
  return _mm512_maskz_sqrt_pd(every, value);
}
inline Part least_part(Part a, Part b) {
  return _mm512_maskz_min_pd(every, a, b);
}
inline Part largest_part(Part a, Part b) {
  return _mm512_maskz_max_pd(every, a, b);
}

}  // namespace
}  // namespace capsoc::identification

#include "identification/kernels_body.h"

const capsoc::identification::Kernels capsoc::identification::kernels_avx512 =
    capsoc::identification::all;
