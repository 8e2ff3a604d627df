// The sums of kernels.h, written once on packs of eight lanes. Included by kernels_portable.cpp,
// kernels_sse2.cpp, kernels_avx2.cpp and kernels_avx512.cpp after they define Part, parts, and the
// four operations that have no operator: splat, root, least, largest. Everything here has internal
// linkage.
//
// What was measured (gradient of a batch of 1,000): AVX-512 1.0 us, AVX2 1.4 us, SSE2 3.3 us; a
// batch of 100 with AVX-512 0.15 us, and 0.19 us with Adam's update. By the processor's instruction
// tables the root and the division alone take most of that, the products and sums run alongside
// them. An approximate reciprocal root with Newton steps would be another way, but like fused
// multiply-adds it would give other digits at every width.
#pragma once

#include "identification/kernels.h"

namespace capsoc::identification {
namespace {

constexpr std::size_t lanes = 8;

struct Pack {
  Part part[parts];
};

// NOLINTBEGIN(bugprone-macro-parentheses)
#define CAPSOC_LANEWISE(name, expression)                                 \
  [[gnu::always_inline]] inline Pack name(const Pack& a, const Pack& b) { \
    Pack result;                                                          \
    for (int i = 0; i < parts; ++i) {                                     \
      const Part x = a.part[i];                                           \
      const Part y = b.part[i];                                           \
      result.part[i] = expression;                                        \
    }                                                                     \
    return result;                                                        \
  }
CAPSOC_LANEWISE(operator+, x + y)
CAPSOC_LANEWISE(operator-, x - y)
CAPSOC_LANEWISE(operator*, x* y)
CAPSOC_LANEWISE(operator/, x / y)
CAPSOC_LANEWISE(least, least_part(x, y))
CAPSOC_LANEWISE(largest, largest_part(x, y))
#undef CAPSOC_LANEWISE
// NOLINTEND(bugprone-macro-parentheses)

[[gnu::always_inline]] inline Pack& operator+=(Pack& a, const Pack& b) {
  return a = a + b;
}

[[gnu::always_inline]] inline Pack root(const Pack& a) {
  Pack result;
  for (int i = 0; i < parts; ++i) result.part[i] = root_part(a.part[i]);
  return result;
}

[[gnu::always_inline]] inline Pack splat(double value) {
  Pack result;
  for (int i = 0; i < parts; ++i) result.part[i] = splat_part(value);
  return result;
}

[[gnu::always_inline]] inline Pack load(const double* values) {
  Pack result;
  for (int i = 0; i < parts; ++i) {
    __builtin_memcpy(&result.part[i], values + i * (lanes / parts), sizeof(Part));
  }
  return result;
}

[[gnu::always_inline]] inline void store(const Pack& pack, double* values) {
  __builtin_memcpy(values, &pack, sizeof pack);
}

/// The lanes' sum, in the same order for every width.
[[gnu::always_inline]] inline double total(const Pack& pack) {
  double lane[lanes];
  store(pack, lane);
  return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}

/// The samples after the last full pack, filled up with the ellipse's centre, for which all sums
/// but the loss vanish; `used` is 1 in the lanes of samples, else 0.
struct Tail {
  double u[lanes], v[lanes], used[lanes];
};

[[gnu::always_inline]] inline Tail tail_of(const double* u, const double* v, std::size_t count,
                                           double fill_u, double fill_v) {
  Tail tail;
  for (std::size_t i = 0; i < lanes; ++i) {
    const bool used = i < count;
    tail.u[i] = used ? u[i] : fill_u;
    tail.v[i] = used ? v[i] : fill_v;
    tail.used[i] = used ? 1.0 : 0.0;
  }
  return tail;
}

/// Below this Y^2 is taken for 0, so that the centre's derivative is 0 as in the layered network.
constexpr double smallest_square = 1e-300;

struct GradientLoop {
  Pack b1, b2, inverse_a1, inverse_a2, a, twice_b, one, tiny;
  Pack wx, wy, wxx, wxy, wyy, loss;

  [[gnu::always_inline]] inline void add(const Pack& u, const Pack& v, const Pack& used) {
    const Pack x = (u - b1) * inverse_a1;
    const Pack y = (v - b2) * inverse_a2;
    const Pack xx = x * x;
    const Pack yy = y * y;
    const Pack xy = x * y;
    const Pack norm = root(largest(a * (xx + yy) + twice_b * xy, tiny));
    const Pack w = one - one / norm;
    const Pack off = (one - norm) * used;
    wx += w * x;
    wy += w * y;
    wxx += w * xx;
    wxy += w * xy;
    wyy += w * yy;
    loss += off * off;
  }
};

GradientSums gradient(const double* u, const double* v, std::size_t count, FusedForm form) {
  const Pack zero = splat(0);
  const Pack one = splat(1);
  GradientLoop loop = {splat(form.b1),
                       splat(form.b2),
                       splat(form.inverse_a1),
                       splat(form.inverse_a2),
                       splat(form.a),
                       splat(2 * form.b),
                       one,
                       splat(smallest_square),
                       zero,
                       zero,
                       zero,
                       zero,
                       zero,
                       zero};
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) loop.add(load(u + i), load(v + i), one);
  if (i < count) {
    const Tail tail = tail_of(u + i, v + i, count - i, form.b1, form.b2);
    loop.add(load(tail.u), load(tail.v), load(tail.used));
  }
  return {total(loop.wx),  total(loop.wy),  total(loop.wxx),
          total(loop.wxy), total(loop.wyy), total(loop.loss)};
}

struct NormalLoop {
  Pack b1, b2, inverse_a1, inverse_a2, a, b, a_by_t, twice_b_by_t, one, tiny;
  Pack jj[15], rj[5], loss;

  [[gnu::always_inline]] inline void add(const Pack& u, const Pack& v, const Pack& used) {
    const Pack x = (u - b1) * inverse_a1;
    const Pack y = (v - b2) * inverse_a2;
    const Pack by_x = a * x + b * y;  // half the derivative of Y^2
    const Pack by_y = a * y + b * x;
    const Pack norm = root(largest(x * by_x + y * by_y, tiny));
    const Pack inverse = one / norm;
    const Pack g = by_x * inverse;
    const Pack h = by_y * inverse;
    const Pack by_t = (a_by_t * (x * x + y * y) + twice_b_by_t * (x * y)) * inverse;
    const Pack j[5] = {x * g, y * h, g, h, by_t};
    const Pack off = (one - norm) * used;
    int k = 0;
    for (int row = 0; row < 5; ++row) {
      for (int column = 0; column <= row; ++column) jj[k++] += j[row] * j[column];
      rj[row] += off * j[row];
    }
    loss += off * off;
  }
};

NormalSums normal(const double* u, const double* v, std::size_t count, FusedForm form) {
  const Pack zero = splat(0);
  const Pack one = splat(1);
  NormalLoop loop;
  loop.b1 = splat(form.b1);
  loop.b2 = splat(form.b2);
  loop.inverse_a1 = splat(form.inverse_a1);
  loop.inverse_a2 = splat(form.inverse_a2);
  loop.a = splat(form.a);
  loop.b = splat(form.b);
  loop.a_by_t = splat(form.a_by_t);
  loop.twice_b_by_t = splat(2 * form.b_by_t);
  loop.one = one;
  loop.tiny = splat(smallest_square);
  for (Pack& sum : loop.jj) sum = zero;
  for (Pack& sum : loop.rj) sum = zero;
  loop.loss = zero;
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) loop.add(load(u + i), load(v + i), one);
  if (i < count) {
    const Tail tail = tail_of(u + i, v + i, count - i, form.b1, form.b2);
    loop.add(load(tail.u), load(tail.v), load(tail.used));
  }
  NormalSums sums;
  for (int k = 0; k < 15; ++k) sums.jj[k] = total(loop.jj[k]);
  for (int k = 0; k < 5; ++k) sums.rj[k] = total(loop.rj[k]);
  sums.loss = total(loop.loss);
  return sums;
}

struct MomentLoop {
  Pack centre_u, centre_v, inverse_u, inverse_v;
  Pack x, y, xx, xy, yy, xxx, xxy, xyy, yyy, xxxx, xxxy, xxyy, xyyy, yyyy;

  [[gnu::always_inline]] inline void add(const Pack& u, const Pack& v) {
    const Pack p = (u - centre_u) * inverse_u;
    const Pack q = (v - centre_v) * inverse_v;
    const Pack pp = p * p;
    const Pack pq = p * q;
    const Pack qq = q * q;
    x += p;
    y += q;
    xx += pp;
    xy += pq;
    yy += qq;
    xxx += pp * p;
    xxy += pp * q;
    xyy += qq * p;
    yyy += qq * q;
    xxxx += pp * pp;
    xxxy += pp * pq;
    xxyy += pp * qq;
    xyyy += pq * qq;
    yyyy += qq * qq;
  }
};

MomentSums moments(const double* u, const double* v, std::size_t count, double centre_u,
                   double centre_v, double inverse_scale_u, double inverse_scale_v) {
  const Pack zero = splat(0);
  MomentLoop loop = {splat(centre_u),
                     splat(centre_v),
                     splat(inverse_scale_u),
                     splat(inverse_scale_v),
                     zero,
                     zero,
                     zero,
                     zero,
                     zero,
                     zero,
                     zero,
                     zero,
                     zero,
                     zero,
                     zero,
                     zero,
                     zero,
                     zero};
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) loop.add(load(u + i), load(v + i));
  if (i < count) {
    const Tail tail = tail_of(u + i, v + i, count - i, centre_u, centre_v);
    loop.add(load(tail.u), load(tail.v));
  }
  return {total(loop.x),    total(loop.y),    total(loop.xx),   total(loop.xy),  total(loop.yy),
          total(loop.xxx),  total(loop.xxy),  total(loop.xyy),  total(loop.yyy), total(loop.xxxx),
          total(loop.xxxy), total(loop.xxyy), total(loop.xyyy), total(loop.yyyy)};
}

Extent extent(const double* u, const double* v, std::size_t count) {
  Pack sum_u = splat(0), sum_v = splat(0);
  Pack least_u = splat(u[0]), least_v = splat(v[0]);
  Pack largest_u = least_u, largest_v = least_v;
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const Pack p = load(u + i);
    const Pack q = load(v + i);
    sum_u += p;
    sum_v += q;
    least_u = least(least_u, p);
    least_v = least(least_v, q);
    largest_u = largest(largest_u, p);
    largest_v = largest(largest_v, q);
  }
  Extent result = {total(sum_u), total(sum_v), u[0], v[0], u[0], v[0]};
  const auto bound = [](double& low, double& high, double value) {
    if (value < low) low = value;
    if (value > high) high = value;
  };
  double lane[4][lanes];
  store(least_u, lane[0]);
  store(largest_u, lane[1]);
  store(least_v, lane[2]);
  store(largest_v, lane[3]);
  for (std::size_t k = 0; k < lanes; ++k) {
    bound(result.least_u, result.largest_u, lane[0][k]);
    bound(result.least_u, result.largest_u, lane[1][k]);
    bound(result.least_v, result.largest_v, lane[2][k]);
    bound(result.least_v, result.largest_v, lane[3][k]);
  }
  for (; i < count; ++i) {
    result.sum_u += u[i];
    result.sum_v += v[i];
    bound(result.least_u, result.largest_u, u[i]);
    bound(result.least_v, result.largest_v, v[i]);
  }
  return result;
}

constexpr Kernels all = {gradient, normal, moments, extent};

}  // namespace
}  // namespace capsoc::identification
