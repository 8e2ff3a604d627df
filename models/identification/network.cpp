#include "identification/network.h"

#include <cmath>

namespace capsoc::identification {
namespace {

constexpr double half_sqrt2 = 0.70710678118654752440;

}  // namespace

Nodes to_nodes(const Parameters& parameters) {
  Nodes nodes;
  nodes << parameters.a1, parameters.a2, parameters.b1, parameters.b2,
      std::tan(parameters.beta / 2);
  return nodes;
}

Parameters to_parameters(const Nodes& nodes) {
  double t = nodes[4];
  if (std::abs(t) > 1) t = 1 / t;  // sin(beta), all that Eq (6) has of beta's sign, is the same
  if ((nodes[0] < 0) != (nodes[1] < 0)) t = -t;
  return {std::abs(nodes[0]), std::abs(nodes[1]), nodes[2], nodes[3], 2 * std::atan(t)};
}

void AffineLayer::forward(const Channel& u, const Channel& v, Signals& x1) const {
  x1.u.head(u.size()) = (u - b1) / a1;
  x1.v.head(u.size()) = (v - b2) / a2;
}

void AffineLayer::backward(const Signals& x1, const Signals& d_x1, Eigen::Index count,
                           Eigen::Ref<Jacobian> columns) const {
  // Eq (22) prints u for V in dX1/da2, which is (-(V - b2)/a2^2, 0)^T. With X1 from the forward
  // pass (U - b1)/a1^2 is U1/a1 and (V - b2)/a2^2 is V1/a2.
  columns.col(0).head(count).array() = d_x1.u.head(count) * x1.u.head(count) * (-1 / a1);
  columns.col(1).head(count).array() = d_x1.v.head(count) * x1.v.head(count) * (-1 / a2);
  columns.col(2).head(count).array() = d_x1.u.head(count) * (-1 / a1);
  columns.col(3).head(count).array() = d_x1.v.head(count) * (-1 / a2);
}

// Eq (7) prints the transpose of R; the right-hand side of Eq (8) is right: V2 = (V1 - U1)/sqrt 2,
// U2 = (V1 + U1)/sqrt 2. Eq (9) then is V1^2 + U1^2 = V2^2 + U2^2, without its 1/2.
void RotationLayer::forward(const Signals& x1, Eigen::Index count, Signals& x2) const {
  x2.v.head(count) = half_sqrt2 * (x1.v.head(count) - x1.u.head(count));
  x2.u.head(count) = half_sqrt2 * (x1.v.head(count) + x1.u.head(count));
}

// dX2/dX1 of Eq (21), transposed because derivatives are propagated as columns here.
void RotationLayer::backward(const Signals& d_x2, Eigen::Index count, Signals& d_x1) const {
  d_x1.v.head(count) = half_sqrt2 * (d_x2.u.head(count) + d_x2.v.head(count));
  d_x1.u.head(count) = half_sqrt2 * (d_x2.u.head(count) - d_x2.v.head(count));
}

void CoefficientLayer::forward() {
  const double root = std::sqrt(1 + t * t);
  inverse_l = root / (1 + t);
  inverse_s = root / (1 - t);
}

// Eq (25)'s fourth formula: the values are right, but its label dX2/dX1 must read dt2/dt.
Eigen::Vector2d CoefficientLayer::backward() const {
  const double root = std::sqrt(1 + t * t);
  return {(t - 1) / ((1 + t) * (1 + t) * root), (t + 1) / ((1 - t) * (1 - t) * root)};
}

void ScalingLayer::forward(const Signals& x2, Eigen::Index count, Signals& x3) const {
  x3.v.head(count) = inverse_l * x2.v.head(count);
  x3.u.head(count) = inverse_s * x2.u.head(count);
}

void ScalingLayer::backward(const Signals& d_x3, Eigen::Index count, Signals& d_x2) const {
  d_x2.v.head(count) = inverse_l * d_x3.v.head(count);
  d_x2.u.head(count) = inverse_s * d_x3.u.head(count);
}

void NormLayer::forward(const Signals& x3, Eigen::Index count, Eigen::ArrayXd& y) const {
  y.head(count) = (x3.u.head(count).square() + x3.v.head(count).square()).sqrt();
}

// Eq (21): dY/dX3 = X3^T/Y (the paper's X3^1 is a misprint). In the centre of the ellipse, where Y
// has no derivative, 0 is used.
void NormLayer::backward(const Signals& x3, const Eigen::ArrayXd& y, Eigen::Index count,
                         Signals& d_x3) const {
  d_x3.v.head(count) = x3.v.head(count) / y.head(count).max(1e-300);
  d_x3.u.head(count) = x3.u.head(count) / y.head(count).max(1e-300);
}

double LossLayer::forward(const Eigen::ArrayXd& y, Eigen::Index count) const {
  return (1 - y.head(count)).square().mean();
}

void LossLayer::backward(const Eigen::ArrayXd& y, Eigen::Index count, Eigen::ArrayXd& d_y) const {
  d_y.head(count) = -2 * (1 - y.head(count));
}

Network::Network(Eigen::Index capacity)
    : x1_(capacity),
      x2_(capacity),
      x3_(capacity),
      d_x1_(capacity),
      d_x2_(capacity),
      d_x3_(capacity),
      y_(capacity),
      d_y_(capacity),
      residuals_(capacity),
      jacobian_(capacity, 5) {}

void Network::set_nodes(const Nodes& nodes) {
  affine_ = {nodes[0], nodes[1], nodes[2], nodes[3]};
  coefficient_.t = nodes[4];
}

double Network::forward(const Channel& u, const Channel& v) {
  count_ = u.size();
  affine_.forward(u, v, x1_);
  rotation_.forward(x1_, count_, x2_);
  coefficient_.forward();
  scaling_ = {coefficient_.inverse_l, coefficient_.inverse_s};
  scaling_.forward(x2_, count_, x3_);
  norm_.forward(x3_, count_, y_);
  return loss_.forward(y_, count_);
}

Nodes Network::backward() {
  jacobian();
  loss_.backward(y_, count_, d_y_);
  return jacobian_.topRows(count_).transpose().lazyProduct(d_y_.head(count_).matrix()) /
         static_cast<double>(count_);
}

Eigen::Ref<const Eigen::ArrayXd> Network::residuals() {
  residuals_.head(count_) = 1 - y_.head(count_);
  return residuals_.head(count_);
}

Eigen::Ref<const Jacobian> Network::jacobian() {
  norm_.backward(x3_, y_, count_, d_x3_);
  scaling_.backward(d_x3_, count_, d_x2_);
  rotation_.backward(d_x2_, count_, d_x1_);
  affine_.backward(x1_, d_x1_, count_, jacobian_);
  // Eq (24); the third formula of Eq (25) is dX3/dt2 = diag(V2, U2), whatever its label says.
  const Eigen::Vector2d d_t2 = coefficient_.backward();
  jacobian_.col(4).head(count_).array() = d_t2[0] * d_x3_.v.head(count_) * x2_.v.head(count_) +
                                          d_t2[1] * d_x3_.u.head(count_) * x2_.u.head(count_);
  return jacobian_.topRows(count_);
}

}  // namespace capsoc::identification
