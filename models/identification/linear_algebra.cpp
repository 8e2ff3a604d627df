#include "identification/linear_algebra.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace capsoc::identification {

using Matrix = Eigen::MatrixXd;

Matrix solve_symmetric(const MatrixRef& a, const MatrixRef& b) {
  return Eigen::LDLT<Matrix>(a).solve(b);
}

Matrix pseudo_inverse_of(const MatrixRef& a) {
  return Eigen::CompleteOrthogonalDecomposition<Matrix>(a).pseudoInverse();
}

SymmetricEigen eigen_of_symmetric(const MatrixRef& a) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(a);
  if (eigen.info() != Eigen::Success) return {};
  return {true, eigen.eigenvalues(), eigen.eigenvectors()};
}

SymmetricEigen eigen_of_pencil(const MatrixRef& a, const MatrixRef& b) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> eigen(a, b);
  if (eigen.info() != Eigen::Success) return {};
  return {true, eigen.eigenvalues(), eigen.eigenvectors()};
}

Matrix eigenvectors_of(const MatrixRef& a) {
  const Eigen::EigenSolver<Matrix> eigen(a);
  if (eigen.info() != Eigen::Success) return {};
  return eigen.eigenvectors().real();
}

}  // namespace capsoc::identification
