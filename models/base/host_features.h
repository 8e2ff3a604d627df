// What the host's processor can do and the system lets it.
#pragma once

// Clang's C++ does not know the header's _Bool.
#if __has_include(<sys/platform/x86.h>) && !defined(__clang__)
#include <sys/platform/x86.h>
#endif

namespace capsoc {

// The C library knows since it loaded the program. The compiler's own test asks the processor
// again at every start, which a hypervisor answers slowly.
#ifdef CPU_FEATURE_ACTIVE
inline bool host_has_bit_manipulation() {
  return CPU_FEATURE_ACTIVE(BMI1) && CPU_FEATURE_ACTIVE(BMI2);
}
inline bool host_has_avx2() {
  return CPU_FEATURE_ACTIVE(AVX2);
}
inline bool host_has_avx512() {
  return CPU_FEATURE_ACTIVE(AVX512F);
}
#else
inline bool host_has_bit_manipulation() {
  return __builtin_cpu_supports("bmi") != 0 && __builtin_cpu_supports("bmi2") != 0;
}
inline bool host_has_avx2() {
  return __builtin_cpu_supports("avx2") != 0;
}
inline bool host_has_avx512() {
  return __builtin_cpu_supports("avx512f") != 0;
}
#endif

}  // namespace capsoc
