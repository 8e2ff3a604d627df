// kernels.h for any processor: two doubles at a time in the compiler's own vectors, which are
// NEON's on arm64.
namespace capsoc::identification {
namespace {

using Part = double __attribute__((vector_size(16)));
constexpr int parts = 4;
inline Part splat_part(double value) {
  return Part{value, value};
}
inline Part root_part(Part value) {
  return Part{__builtin_sqrt(value[0]), __builtin_sqrt(value[1])};
}
// Of two of which one is not a number the second, as x86-64 has it.
inline Part least_part(Part a, Part b) {
  return Part{a[0] < b[0] ? a[0] : b[0], a[1] < b[1] ? a[1] : b[1]};
}
inline Part largest_part(Part a, Part b) {
  return Part{a[0] > b[0] ? a[0] : b[0], a[1] > b[1] ? a[1] : b[1]};
}

}  // namespace
}  // namespace capsoc::identification

#include "identification/kernels_body.h"

const capsoc::identification::Kernels capsoc::identification::kernels_portable =
    capsoc::identification::all;
