// Sums over samples: in portable code, and for every vector width of an x86-64, chosen at run time.
//
// This header is included by sources that are compiled for newer processors. Nothing in it may be
// an inline function: the linker keeps one copy of such a function, and it could be the one that
// an older processor cannot execute.
#pragma once

#include <cstddef>

namespace capsoc::identification {

enum class Width { portable, sse2, avx2, avx512 };

/// A batch through the fused form (fused_network.h): x = (U - b1) inverse_a1,
/// y = (V - b2) inverse_a2, Y^2 = a (x^2 + y^2) + 2 b xy. a_by_t, b_by_t: derivatives of a, b.
struct FusedForm {
  double b1, b2, inverse_a1, inverse_a2, a, b, a_by_t, b_by_t;
};

/// Sums over a batch with w = 1 - 1/Y.
struct GradientSums {
  double wx, wy, wxx, wxy, wyy, loss;
};

/// Sums over a batch of j j^T (rows of its lower triangle), (1 - Y) j and (1 - Y)^2.
/// Here j is the derivative of Y by the nodes, without the constants (-1/a1, -1/a2, -1/a1, -1/a2,
/// 1/2).
struct NormalSums {
  double jj[15], rj[5], loss;
};

/// Sums of x^i y^j, x and y the samples shifted and scaled.
struct MomentSums {
  double x, y, xx, xy, yy, xxx, xxy, xyy, yyy, xxxx, xxxy, xxyy, xyyy, yyyy;
};

/// Sums and bounds of both channels. Values that are not finite make the sums so; the bounds are
/// then undefined.
struct Extent {
  double sum_u, sum_v, least_u, least_v, largest_u, largest_v;
};

/// All widths add in the same order, in eight lanes, and fuse no multiplication with an addition:
/// they give the same digits.
struct Kernels {
  GradientSums (*gradient)(const double* u, const double* v, std::size_t count, FusedForm form);
  NormalSums (*normal)(const double* u, const double* v, std::size_t count, FusedForm form);
  MomentSums (*moments)(const double* u, const double* v, std::size_t count, double centre_u,
                        double centre_v, double inverse_scale_u, double inverse_scale_v);
  Extent (*extent)(const double* u, const double* v, std::size_t count);
};

/// Whether this processor and its operating system can execute that width.
bool supported(Width width);
/// The widest that is supported.
Width widest();
/// "portable", "SSE2", "AVX2", "AVX-512".
const char* to_string(Width width);
/// Only call what a supported() width gives.
const Kernels& kernels(Width width);

extern const Kernels kernels_portable;
// Of a build for x86-64 only.
extern const Kernels kernels_sse2;
extern const Kernels kernels_avx2;
extern const Kernels kernels_avx512;

}  // namespace capsoc::identification
