// What the host's processor can do and the system lets it.
#pragma once

// Clang's C++ does not know the header's _Bool.
#if defined(__x86_64__) && __has_include(<sys/platform/x86.h>) && !defined(__clang__)
#include <sys/platform/x86.h>
#endif

namespace capsoc {

#if defined(__x86_64__)
constexpr bool host_is_x86_64 = true;
#else
constexpr bool host_is_x86_64 = false;
#endif

// The C library knows since it loaded the program. The compiler's own test asks the processor
// again at every start, which a hypervisor answers slowly.
#ifdef CPU_FEATURE_ACTIVE
inline bool host_has_bit_manipulation() {
  return CPU_FEATURE_ACTIVE(BMI1) && CPU_FEATURE_ACTIVE(BMI2);
}
inline bool host_has_fused_multiply_add() {
  return CPU_FEATURE_ACTIVE(FMA);
}
inline bool host_has_avx2() {
  return CPU_FEATURE_ACTIVE(AVX2);
}
inline bool host_has_avx512() {
  return CPU_FEATURE_ACTIVE(AVX512F);
}
#elif defined(__x86_64__)
inline bool host_has_bit_manipulation() {
  return __builtin_cpu_supports("bmi") != 0 && __builtin_cpu_supports("bmi2") != 0;
}
inline bool host_has_fused_multiply_add() {
  return __builtin_cpu_supports("fma") != 0;
}
inline bool host_has_avx2() {
  return __builtin_cpu_supports("avx2") != 0;
}
inline bool host_has_avx512() {
  return __builtin_cpu_supports("avx512f") != 0;
}
#else
inline bool host_has_bit_manipulation() {
  return false;
}
inline bool host_has_fused_multiply_add() {
  return false;
}
inline bool host_has_avx2() {
  return false;
}
inline bool host_has_avx512() {
  return false;
}
#endif

}  // namespace capsoc
