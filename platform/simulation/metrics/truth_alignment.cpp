#include "metrics/truth_alignment.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>

#include "base/constants.h"

namespace capsoc::metrics {
namespace {

/// What the fit leaves of a channel's scatter, at most: stale samples in a part of a recording move
/// its zero by more than 10 degrees only where they leave more.
constexpr double unexplained = 0.1;

}  // namespace

std::optional<TruthAlignment> recorded_alignment(sensor::Source& source) {
  if (source.description().motion != sensor::MotionKind::recorded) return std::nullopt;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> moments = Eigen::Matrix<double, 3, 2>::Zero();
  Eigen::Array2d squares = Eigen::Array2d::Zero();
  bool complete = true;
  source.rewind();
  for (uint64_t k = 0; complete; ++k) {
    const auto value = source.sample(k, 0);
    if (!value) break;
    complete = value->has_truth;
    const double angle = value->angle_turns * two_pi;
    const Eigen::Vector3d row(std::sin(angle), std::cos(angle), 1);
    normal += row * row.transpose();
    const Eigen::RowVector2d channels(value->u, value->v);
    moments += row * channels;
    squares += channels.array().square().transpose();
  }
  source.rewind();
  if (!complete) return std::nullopt;
  const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
  if (solver.info() != Eigen::Success || solver.rcond() < 1e-9) return std::nullopt;
  const Eigen::Matrix<double, 3, 2> found = solver.solve(moments);
  const Eigen::Array2d left =
      squares - (found.array() * moments.array()).colwise().sum().transpose();
  const Eigen::Array2d scatter =
      squares - moments.row(2).array().square().transpose() / normal(2, 2);
  if ((left > unexplained * scatter).any()) return std::nullopt;
  const Eigen::Vector2d u = found.block<2, 1>(0, 0), v = found.block<2, 1>(0, 1);
  const double area = u.x() * v.y() - u.y() * v.x();
  if (!(std::fabs(area) > 0.05 * u.norm() * v.norm())) return std::nullopt;
  return TruthAlignment{std::atan2(u.y(), u.x()) / two_pi, area < 0};
}

std::optional<std::string> own_zero(const std::string& file,
                                    const std::optional<TruthAlignment>& alignment) {
  if (!alignment || std::fabs(alignment->zero_turns) <= own_zero_turns) return std::nullopt;
  return fmt::format(
      "{}: the recorded angle is 0 where that of channel U is {:.3f} deg: errors are counted with "
      "this difference taken off",
      file, alignment->zero_turns * 360);
}

}  // namespace capsoc::metrics
