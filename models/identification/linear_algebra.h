// The decompositions that the fits use, for small matrices of any size. They are instantiated here
// and nowhere else: each costs the compiler seconds, and with sizes in the types again for
// every size.
#pragma once

#include <Eigen/Core>

namespace capsoc::identification {

using MatrixRef = Eigen::Ref<const Eigen::MatrixXd>;

/// x of a x = b with a symmetric, by L D L^T. Not finite where a is singular.
Eigen::MatrixXd solve_symmetric(const MatrixRef& a, const MatrixRef& b);

/// The inverse of Moore and Penrose, by a complete orthogonal decomposition.
Eigen::MatrixXd pseudo_inverse_of(const MatrixRef& a);

/// Eigenvalues, the smallest first, and one eigenvector a column.
struct SymmetricEigen {
  bool found = false;  ///< the iteration converged
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

/// a x = lambda x with a symmetric.
SymmetricEigen eigen_of_symmetric(const MatrixRef& a);

/// a x = lambda b x with a symmetric and b symmetric and positive definite.
SymmetricEigen eigen_of_pencil(const MatrixRef& a, const MatrixRef& b);

/// Real parts of the eigenvectors of any square matrix, one a column; empty if the iteration did
/// not converge.
Eigen::MatrixXd eigenvectors_of(const MatrixRef& a);

}  // namespace capsoc::identification
