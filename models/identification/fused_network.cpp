#include "identification/fused_network.h"

namespace capsoc::identification {
namespace {

FusedForm form_of(const Nodes& nodes) {
  const double t = nodes[4];
  const double long_axis = 1 / (1 + t);
  const double short_axis = 1 / (1 - t);
  const double square = 1 + t * t;
  const double inverse_l2 = square * long_axis * long_axis;
  const double inverse_s2 = square * short_axis * short_axis;
  const double inverse_l2_by_t = 2 * (t - 1) * long_axis * long_axis * long_axis;
  const double inverse_s2_by_t = 2 * (t + 1) * short_axis * short_axis * short_axis;
  return {nodes[2],
          nodes[3],
          1 / nodes[0],
          1 / nodes[1],
          (inverse_l2 + inverse_s2) / 2,
          (inverse_s2 - inverse_l2) / 2,
          (inverse_l2_by_t + inverse_s2_by_t) / 2,
          (inverse_s2_by_t - inverse_l2_by_t) / 2};
}

}  // namespace

FusedNetwork::Gradient FusedNetwork::gradient(const Nodes& nodes, const Channel& u,
                                              const Channel& v) const {
  const FusedForm f = form_of(nodes);
  const GradientSums s = kernels_.gradient(u.data(), v.data(), u.size(), f);
  const double share = 1 / static_cast<double>(u.size());
  const double by_u = -2 * share * f.inverse_a1;
  const double by_v = -2 * share * f.inverse_a2;
  Gradient result;
  result.loss = s.loss * share;
  result.by_nodes << by_u * (f.a * s.wxx + f.b * s.wxy), by_v * (f.a * s.wyy + f.b * s.wxy),
      by_u * (f.a * s.wx + f.b * s.wy), by_v * (f.a * s.wy + f.b * s.wx),
      share * ((s.wxx + s.wyy) * f.a_by_t + 2 * s.wxy * f.b_by_t);
  return result;
}

FusedNetwork::Normal FusedNetwork::normal(const Nodes& nodes, const Channel& u,
                                          const Channel& v) const {
  const FusedForm f = form_of(nodes);
  const NormalSums s = kernels_.normal(u.data(), v.data(), u.size(), f);
  const double factor[5] = {-f.inverse_a1, -f.inverse_a2, -f.inverse_a1, -f.inverse_a2, 0.5};
  Normal result;
  result.loss = s.loss / static_cast<double>(u.size());
  int k = 0;
  for (int row = 0; row < 5; ++row) {
    result.jtr[row] = s.rj[row] * factor[row];
    for (int column = 0; column <= row; ++column) {
      result.jtj(row, column) = s.jj[k++] * factor[row] * factor[column];
      result.jtj(column, row) = result.jtj(row, column);
    }
  }
  return result;
}

double FusedNetwork::loss(const Nodes& nodes, const Channel& u, const Channel& v) const {
  const GradientSums s = kernels_.gradient(u.data(), v.data(), u.size(), form_of(nodes));
  return s.loss / static_cast<double>(u.size());
}

}  // namespace capsoc::identification
