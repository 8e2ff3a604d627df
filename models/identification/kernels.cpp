#include "identification/kernels.h"

#include "base/host_features.h"

namespace capsoc::identification {

bool supported(Width width) {
  switch (width) {
    case Width::avx512:
      return host_has_avx512();
    case Width::avx2:
      return host_has_avx2();
    case Width::sse2:
      break;
  }
  return true;
}

Width widest() {
  if (supported(Width::avx512)) return Width::avx512;
  return supported(Width::avx2) ? Width::avx2 : Width::sse2;
}

const char* to_string(Width width) {
  switch (width) {
    case Width::avx512:
      return "AVX-512";
    case Width::avx2:
      return "AVX2";
    case Width::sse2:
      break;
  }
  return "SSE2";
}

const Kernels& kernels(Width width) {
  switch (width) {
    case Width::avx512:
      return kernels_avx512;
    case Width::avx2:
      return kernels_avx2;
    case Width::sse2:
      break;
  }
  return kernels_sse2;
}

}  // namespace capsoc::identification
