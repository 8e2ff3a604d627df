#include "signal_shape.h"

#include <math.h>

enum { unknowns = 5, orders = 5, fewest_samples = 12 };
// A channel that moves by less than this part of the other one is dead.
#define DEAD 0.02
// Both stand still within this part of full scale.
#define STILL 1e-4
// Distance from an ellipse, RMS in parts of its radius, beyond which the samples are on none.
#define FAR 0.04

static double number(int32_t word) {
  return word * 0x1p-31;
}

void signal_shape_feed(struct signal_shape* shape, int32_t u, int32_t v) {
  if (shape->samples++ == 0) {
    shape->u_first = shape->u_least = shape->u_greatest = u;
    shape->v_first = shape->v_least = shape->v_greatest = v;
  }
  if (u < shape->u_least) shape->u_least = u;
  if (u > shape->u_greatest) shape->u_greatest = u;
  if (v < shape->v_least) shape->v_least = v;
  if (v > shape->v_greatest) shape->v_greatest = v;
  const double x = number(u) - number(shape->u_first), y = number(v) - number(shape->v_first);
  double x_power = 1;
  for (int i = 0; i < orders; ++i, x_power *= x) {
    double term = x_power;
    for (int j = 0; i + j < orders; ++j, term *= y) shape->moments[i][j] += term;
  }
}

// Moments about the mean in units of the spread: that keeps the equations well conditioned, and the
// mean of samples on an arc lies inside the ellipse.
struct standard {
  double u, v;                // the mean, from the first sample
  double u_spread, v_spread;  // standard deviation
  double moments[orders][orders];
};

static double power(double base, int exponent) {
  return exponent == 0 ? 1 : base * power(base, exponent - 1);
}

static double about_mean(const struct signal_shape* shape, double u, double v, int i, int j) {
  static const double choose[orders][orders] = {
      {1}, {1, 1}, {1, 2, 1}, {1, 3, 3, 1}, {1, 4, 6, 4, 1}};
  double sum = 0;
  for (int p = 0; p <= i; ++p)
    for (int q = 0; q <= j; ++q)
      sum +=
          choose[i][p] * choose[j][q] * power(-u, i - p) * power(-v, j - q) * shape->moments[p][q];
  return sum;
}

static struct standard standardise(const struct signal_shape* shape) {
  const double n = shape->samples;
  struct standard s = {.u = shape->moments[1][0] / n, .v = shape->moments[0][1] / n};
  s.u_spread = sqrt(fmax(0, about_mean(shape, s.u, s.v, 2, 0) / n));
  s.v_spread = sqrt(fmax(0, about_mean(shape, s.u, s.v, 0, 2) / n));
  for (int i = 0; i < orders; ++i)
    for (int j = 0; i + j < orders; ++j)
      s.moments[i][j] =
          about_mean(shape, s.u, s.v, i, j) / (n * power(s.u_spread, i) * power(s.v_spread, j));
  return s;
}

// c0 x^2 + c1 x y + c2 y^2 + c3 x + c4 y = 1 by least squares: Gauss with pivots. False if the
// samples do not tell a conic.
static bool solve(double m[unknowns][unknowns + 1], double solution[unknowns]) {
  for (int column = 0; column < unknowns; ++column) {
    int pivot = column;
    for (int row = column + 1; row < unknowns; ++row)
      if (fabs(m[row][column]) > fabs(m[pivot][column])) pivot = row;
    if (!(fabs(m[pivot][column]) > 1e-13)) return false;
    for (int j = 0; j <= unknowns; ++j) {
      const double other = m[column][j];
      m[column][j] = m[pivot][j];
      m[pivot][j] = other;
    }
    for (int row = column + 1; row < unknowns; ++row) {
      const double factor = m[row][column] / m[column][column];
      for (int j = column; j <= unknowns; ++j) m[row][j] -= factor * m[column][j];
    }
  }
  for (int i = unknowns - 1; i >= 0; --i) {
    double rest = m[i][unknowns];
    for (int j = i + 1; j < unknowns; ++j) rest -= m[i][j] * solution[j];
    solution[i] = rest / m[i][i];
  }
  return true;
}

// The conic as U = a1 sin t + b1, V = a2 cos(t + beta) + b2. False unless it is an ellipse;
// `scale` is the 1 on the right about its centre.
static bool to_ellipse(const double c[unknowns], struct signal_ellipse* ellipse, double* scale) {
  const double determinant = 4 * c[0] * c[2] - c[1] * c[1];
  if (!(determinant > 0)) return false;
  ellipse->b1 = (c[1] * c[4] - 2 * c[2] * c[3]) / determinant;
  ellipse->b2 = (c[1] * c[3] - 2 * c[0] * c[4]) / determinant;
  *scale = 1 - (c[3] * ellipse->b1 + c[4] * ellipse->b2) / 2;
  const double squared_1 = 4 * c[2] * *scale / determinant;
  const double squared_2 = 4 * c[0] * *scale / determinant;
  if (!(squared_1 > 0) || !(squared_2 > 0)) return false;
  ellipse->a1 = sqrt(squared_1);
  ellipse->a2 = sqrt(squared_2);
  // With x and y the parts of a1 and a2: x^2 + y^2 + 2 x y sin beta = cos^2 beta.
  const double sine = copysign(c[1], c[0] * c[1]) / (2 * sqrt(c[0] * c[2]));
  ellipse->beta = asin(fmax(-1, fmin(1, sine)));
  return true;
}

// Root mean square distance of the samples from the conic, in parts of its radius.
static double distance(const struct standard* s, const double c[unknowns], double scale) {
  const double fitted = c[0] * s->moments[2][0] + c[1] * s->moments[1][1] +
                        c[2] * s->moments[0][2] + c[3] * s->moments[1][0] + c[4] * s->moments[0][1];
  return sqrt(fmax(0, 1 - fitted)) / 2 / fabs(scale);
}

enum signal_kind signal_shape_kind(const struct signal_shape* shape,
                                   struct signal_ellipse* ellipse) {
  if (shape->samples < fewest_samples) return signal_unknown;
  const double u_range = number(shape->u_greatest) - number(shape->u_least);
  const double v_range = number(shape->v_greatest) - number(shape->v_least);
  if (u_range < STILL && v_range < STILL) return signal_at_rest;
  if (u_range < DEAD * v_range) return signal_u_dead;
  if (v_range < DEAD * u_range) return signal_v_dead;
  static const int exponents[unknowns + 1][2] = {{2, 0}, {1, 1}, {0, 2}, {1, 0}, {0, 1}, {0, 0}};
  const struct standard s = standardise(shape);
  double m[unknowns][unknowns + 1], c[unknowns], scale = 0;
  for (int i = 0; i < unknowns; ++i)
    for (int j = 0; j <= unknowns; ++j)
      m[i][j] = s.moments[exponents[i][0] + exponents[j][0]][exponents[i][1] + exponents[j][1]];
  if (fabs(s.moments[1][1]) > 0.9995 || !solve(m, c)) return signal_same;
  if (!to_ellipse(c, ellipse, &scale)) return signal_other;
  const bool near = distance(&s, c, scale) < FAR;
  ellipse->a1 *= s.u_spread;
  ellipse->a2 *= s.v_spread;
  ellipse->b1 = number(shape->u_first) + s.u + ellipse->b1 * s.u_spread;
  ellipse->b2 = number(shape->v_first) + s.v + ellipse->b2 * s.v_spread;
  return near ? signal_elliptic : signal_other;
}
