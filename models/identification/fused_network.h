// The same network in fused form: what training needs, from a few sums per batch.
#pragma once

#include "identification/kernels.h"
#include "identification/network.h"

namespace capsoc::identification {

/// With x = (U - b1)/a1 and y = (V - b2)/a2 the layers of network.h collapse to
///   Y^2 = A (x^2 + y^2) + 2 B xy,  A = (1/l^2 + 1/s^2)/2,  B = (1/s^2 - 1/l^2)/2,
///   1/l^2 = (1 + t^2)/(1 + t)^2,   1/s^2 = (1 + t^2)/(1 - t)^2,
/// and with w = 1 - 1/Y the gradient of the mean loss is
///   dL/da1 = -2 <w x (Ax + By)>/a1,  dL/db1 = -2 <w (Ax + By)>/a1,  a2 and b2 alike,
///   dL/dt = <w ((x^2 + y^2) A' + 2 xy B')>:
/// five sums, one root and one division a sample. Nothing is allocated.
class FusedNetwork {
 public:
  explicit FusedNetwork(Width width = widest()) : kernels_(kernels(width)) {}

  struct Gradient {
    double loss = 0;  ///< mean of (1 - Y)^2
    Nodes by_nodes;   ///< of the mean loss
  };
  /// u and v equally long, at least one sample.
  Gradient gradient(const Nodes& nodes, const Channel& u, const Channel& v) const;

  /// What a Gauss-Newton step needs, with J the derivatives of Y by the nodes.
  struct Normal {
    double loss = 0;                  ///< mean of (1 - Y)^2
    Eigen::Matrix<double, 5, 5> jtj;  ///< J^T J
    Nodes jtr;                        ///< J^T (1 - Y)
  };
  Normal normal(const Nodes& nodes, const Channel& u, const Channel& v) const;

  double loss(const Nodes& nodes, const Channel& u, const Channel& v) const;

 private:
  const Kernels& kernels_;
};

}  // namespace capsoc::identification
