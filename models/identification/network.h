// The signal flow network of the CSFN paper (Figures 4 to 6), layer by layer, on batches.
#pragma once

#include <Eigen/Core>

#include "identification/samples.h"

namespace capsoc::identification {

/// The nodes that are trained, in this order: a1, a2, b1, b2, t with t = tan(beta/2), Eq (13).
using Nodes = Eigen::Matrix<double, 5, 1>;
/// One row a sample, one column a node.
using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, 5>;

Nodes to_nodes(const Parameters& parameters);

/// Canonical parameters (see Parameters) of nodes wherever the training left them: the loss is the
/// same for t and 1/t, and for (a, t) and (-a, -t).
Parameters to_parameters(const Nodes& nodes);

/// Two signals of a batch; (V, U) in the paper's order is X of Eq (19). Storage for the largest
/// batch is taken once.
struct Signals {
  explicit Signals(Eigen::Index capacity) : v(capacity), u(capacity) {}
  Eigen::ArrayXd v;
  Eigen::ArrayXd u;
};

/// First affine layer, Eq (5), Figure 5a.
struct AffineLayer {
  double a1 = 1, a2 = 1, b1 = 0, b2 = 0;
  void forward(const Channel& u, const Channel& v, Signals& x1) const;
  /// Per-sample derivatives by a1, a2, b1, b2 (the first four columns), Eq (22), of whatever has
  /// the derivative d_x1 by X1.
  void backward(const Signals& x1, const Signals& d_x1, Eigen::Index count,
                Eigen::Ref<Jacobian> columns) const;
};

/// Rotation by 45 degrees, Eq (8), Figure 5b. No parameter.
struct RotationLayer {
  void forward(const Signals& x1, Eigen::Index count, Signals& x2) const;
  void backward(const Signals& d_x2, Eigen::Index count, Signals& d_x1) const;
};

/// t -> t2 = (1/l, 1/s), Eqs (13) and (23), Figure 6b.
struct CoefficientLayer {
  double t = 0;
  double inverse_l = 1, inverse_s = 1;
  void forward();
  /// dt2/dt, Eq (25), as (d(1/l)/dt, d(1/s)/dt).
  Eigen::Vector2d backward() const;
};

/// Third affine layer, Eq (12), Figure 6a: X3 = t2 (x) X2.
struct ScalingLayer {
  double inverse_l = 1, inverse_s = 1;
  void forward(const Signals& x2, Eigen::Index count, Signals& x3) const;
  /// By X2, Eq (21).
  void backward(const Signals& d_x3, Eigen::Index count, Signals& d_x2) const;
};

/// Y = |X3|, Eq (14).
struct NormLayer {
  void forward(const Signals& x3, Eigen::Index count, Eigen::ArrayXd& y) const;
  void backward(const Signals& x3, const Eigen::ArrayXd& y, Eigen::Index count,
                Signals& d_x3) const;
};

/// L = (1 - Y)^2, Eq (15), averaged over the batch.
struct LossLayer {
  double forward(const Eigen::ArrayXd& y, Eigen::Index count) const;
  /// dL/dY of each sample, Eq (21), before the average.
  void backward(const Eigen::ArrayXd& y, Eigen::Index count, Eigen::ArrayXd& d_y) const;
};

/// All layers. After construction nothing is allocated.
class Network {
 public:
  /// capacity: the largest batch that forward() will be given.
  explicit Network(Eigen::Index capacity);

  void set_nodes(const Nodes& nodes);

  /// The mean loss of a batch of 1 .. capacity samples; u and v equally long.
  double forward(const Channel& u, const Channel& v);

  /// Gradient of the mean loss of the last forward() by the nodes, Eqs (20) and (24).
  Nodes backward();

  /// Residuals 1 - Y of the last forward(), valid until the next.
  Eigen::Ref<const Eigen::ArrayXd> residuals();
  /// Derivatives of Y (not of the residual) by the nodes, a row for each sample of the last
  /// forward(); valid until the next call of backward() or jacobian().
  Eigen::Ref<const Jacobian> jacobian();

 private:
  AffineLayer affine_;
  RotationLayer rotation_;
  CoefficientLayer coefficient_;
  ScalingLayer scaling_;
  NormLayer norm_;
  LossLayer loss_;
  Eigen::Index count_ = 0;
  Signals x1_, x2_, x3_, d_x1_, d_x2_, d_x3_;
  Eigen::ArrayXd y_, d_y_, residuals_;
  Jacobian jacobian_;
};

}  // namespace capsoc::identification
