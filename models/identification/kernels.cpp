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
      return host_is_x86_64;
    case Width::portable:
      break;
  }
  return true;
}

Width widest() {
  if (supported(Width::avx512)) return Width::avx512;
  if (supported(Width::avx2)) return Width::avx2;
  return supported(Width::sse2) ? Width::sse2 : Width::portable;
}

const char* to_string(Width width) {
  switch (width) {
    case Width::avx512:
      return "AVX-512";
    case Width::avx2:
      return "AVX2";
    case Width::sse2:
      return "SSE2";
    case Width::portable:
      break;
  }
  return "portable";
}

const Kernels& kernels(Width width) {
#if defined(__x86_64__)
  switch (width) {
    case Width::avx512:
      return kernels_avx512;
    case Width::avx2:
      return kernels_avx2;
    case Width::sse2:
      return kernels_sse2;
    case Width::portable:
      break;
  }
#else
  static_cast<void>(width);
#endif
  return kernels_portable;
}

}  // namespace capsoc::identification
