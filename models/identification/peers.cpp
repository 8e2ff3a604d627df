#include "identification/peers.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/constants.h"
#include "base/random.h"
#include "identification/calibration.h"
#include "identification/ellipse_fit.h"
#include "identification/fused_network.h"
#include "identification/training.h"

namespace capsoc::identification {
namespace {

constexpr int training_steps = 20000;
constexpr Eigen::Index descent_batch = 100;

/// Samples whose largest is 1, so that one rate serves small signals, too.
struct UnitSamples {
  Eigen::ArrayXd u, v;
  double scale;
};

UnitSamples to_unit(const Channel& u, const Channel& v) {
  const double scale = std::max(u.abs().maxCoeff(), v.abs().maxCoeff());
  return {u / scale, v / scale, scale};
}

Parameters from_unit(const Parameters& p, double scale) {
  return {p.a1 * scale, p.a2 * scale, p.b1 * scale, p.b2 * scale, p.beta};
}

/// nodes -= velocity, velocity = memory * velocity + rate * gradient.
Result<PeerAnswer> descend(const Channel& u, const Channel& v, double rate, double memory,
                           uint64_t seed) {
  const UnitSamples samples = to_unit(u, v);
  const FusedNetwork network;
  const Eigen::Index count = std::min(descent_batch, samples.u.size());
  Eigen::ArrayXd batch_u(count), batch_v(count);
  Random random(seed);
  Nodes nodes = to_nodes(paper_start(samples.u, samples.v)), velocity = Nodes::Zero();
  for (int step = 0; step < training_steps; ++step) {
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index k = random.index(samples.u.size());
      batch_u[i] = samples.u[k];
      batch_v[i] = samples.v[k];
    }
    velocity = memory * velocity + rate * network.gradient(nodes, batch_u, batch_v).by_nodes;
    nodes -= velocity;
    const bool inside = nodes.allFinite() && nodes[0] > 0 && nodes[1] > 0 && std::abs(nodes[4]) < 1;
    if (!inside) return Error{"the descent ran away: its rate is too large for this signal"};
  }
  return PeerAnswer{from_unit(to_parameters(nodes), samples.scale), training_steps};
}

/// A u^2 + B uv + C v^2 + D u + E v = 1 with a memory of some 2,000 samples.
Result<PeerAnswer> recursive_least_squares(const Channel& u, const Channel& v) {
  using Vector = Eigen::Matrix<double, 5, 1>;
  using Matrix = Eigen::Matrix<double, 5, 5>;
  constexpr double forgetting = 1 - 1.0 / 2000;
  const UnitSamples samples = to_unit(u, v);
  Matrix covariance = 1e6 * Matrix::Identity();
  Vector conic = Vector::Zero();
  for (Eigen::Index k = 0; k < samples.u.size(); ++k) {
    const double x = samples.u[k], y = samples.v[k];
    Vector row;
    row << x * x, x * y, y * y, x, y;
    const Vector gain = covariance * row / (forgetting + row.dot(covariance * row));
    conic += gain * (1 - row.dot(conic));
    covariance = (covariance - gain * row.transpose() * covariance) / forgetting;
    // Rounding would make it asymmetric, and then it diverges.
    covariance = (covariance + covariance.transpose().eval()) / 2;
  }
  const auto found = parameters_of_conic({conic[0], conic[1], conic[2], conic[3], conic[4], -1});
  if (!found) return Error{found.error()};
  return PeerAnswer{from_unit(found.value(), samples.scale), static_cast<int>(samples.u.size())};
}

/// Where U rises through its middle, in samples, between hysteresis of an eighth of its range.
std::vector<double> crossings(const Channel& u) {
  const double low = u.minCoeff(), high = u.maxCoeff(), middle = (low + high) / 2;
  std::vector<double> found;
  bool armed = false;
  for (Eigen::Index k = 1; k < u.size(); ++k) {
    if (u[k] < middle - (high - low) / 8) armed = true;
    if (!armed || u[k - 1] >= middle || u[k] < middle) continue;
    found.push_back(static_cast<double>(k - 1) + (middle - u[k - 1]) / (u[k] - u[k - 1]));
    armed = false;
  }
  return found;
}

/// Whole turns of the record.
struct Turns {
  double begin, length;  ///< samples; of one turn
  double count;
};

Result<Turns> whole_turns(const Channel& u) {
  constexpr double shortest = 16, unsteady = 0.1;
  const std::vector<double> at = crossings(u);
  if (at.size() < 4)
    return Error{"needs the samples in order of time and three whole turns or more"};
  const double count = static_cast<double>(at.size() - 1);
  const Turns turns{at.front(), (at.back() - at.front()) / count, count};
  bool steady = turns.length >= shortest;
  for (std::size_t i = 1; i < at.size(); ++i)
    steady = steady && std::abs(at[i] - at[i - 1] - turns.length) <= unsteady * turns.length;
  if (!steady) return Error{"needs the samples in order of time at a steady speed"};
  return turns;
}

/// Amplitude and phase of a channel: offset + amplitude sin(omega k + phase).
struct Sine {
  double amplitude, phase, offset;
};

Parameters parameters_of_sines(const Sine& u, const Sine& v) {
  // V = a2 cos(theta + beta) is a2 sin(theta + beta + pi / 2).
  return canonical(
             {u.amplitude, v.amplitude, u.offset, v.offset, wrapped(v.phase - u.phase - pi / 2)})
      .parameters;
}

Sine fourier_line(const Channel& signal, const Turns& turns) {
  const auto first = static_cast<Eigen::Index>(std::ceil(turns.begin));
  const auto count = static_cast<Eigen::Index>(std::llround(turns.count * turns.length));
  const Eigen::Index last = std::min(first + count, signal.size());
  double sine = 0, cosine = 0, sum = 0;
  for (Eigen::Index k = first; k < last; ++k) {
    const double angle = two_pi * static_cast<double>(k) / turns.length;
    sine += signal[k] * std::sin(angle);
    cosine += signal[k] * std::cos(angle);
    sum += signal[k];
  }
  const auto samples = static_cast<double>(last - first);
  return {2 * std::hypot(sine, cosine) / samples, std::atan2(cosine, sine), sum / samples};
}

/// x = (sine, quadrature, offset) turned by omega a sample and corrected by the error of sine +
/// offset. The gains put all three poles of the error at -kappa omega.
Sine observe(const Channel& signal, double omega) {
  constexpr double kappa = 0.3;
  const double offset_gain = omega * kappa * kappa * kappa;
  const double sine_gain = 3 * omega * kappa - offset_gain;
  const double quadrature_gain = omega * (3 * kappa * kappa - 1);
  const double c = std::cos(omega), s = std::sin(omega);
  double sine = 0, quadrature = 0, offset = 0;
  for (Eigen::Index k = 0; k < signal.size(); ++k) {
    const double turned = c * sine + s * quadrature;
    quadrature = c * quadrature - s * sine;
    const double error = signal[k] - turned - offset;
    sine = turned + sine_gain * error;
    quadrature += quadrature_gain * error;
    offset += offset_gain * error;
  }
  return {std::hypot(sine, quadrature), std::atan2(sine, quadrature), offset};
}

/// The first step: y(k + m) + y(k - m) = p y(k) + q with p = 2 cos(m omega), q = (2 - p) offset, an
/// eighth of a turn apart, by a normalised gradient.
struct Oscillation {
  double p = 0, q = 0;
};

constexpr double gradient_rate = 0.01;
constexpr int gradient_passes = 3;

Oscillation first_step(const Channel& y, Eigen::Index apart) {
  Oscillation o;
  for (int pass = 0; pass < gradient_passes; ++pass) {
    for (Eigen::Index k = apart; k + apart < y.size(); ++k) {
      const double error = y[k + apart] + y[k - apart] - o.p * y[k] - o.q;
      const double step = gradient_rate * error / (y[k] * y[k] + 1);
      o.p += step * y[k];
      o.q += step;
    }
  }
  return o;
}

/// The second: amplitude and phase at that speed, the offset known.
Sine second_step(const Channel& y, double omega, double offset) {
  double sine = 0, cosine = 0;
  for (Eigen::Index k = 0; k < y.size(); ++k) {
    const double angle = omega * static_cast<double>(k);
    const double s = std::sin(angle), c = std::cos(angle);
    const double error = y[k] - offset - sine * s - cosine * c;
    sine += omega * error * s;
    cosine += omega * error * c;
  }
  return {std::hypot(sine, cosine), std::atan2(cosine, sine), offset};
}

Result<PeerAnswer> two_steps(const Channel& u, const Channel& v, const Turns& turns) {
  const UnitSamples samples = to_unit(u, v);
  const auto apart = static_cast<Eigen::Index>(std::lround(turns.length / 8));
  const Oscillation one = first_step(samples.u, apart), other = first_step(samples.v, apart);
  const double cosine = (one.p + other.p) / 4;
  if (!(std::abs(cosine) < 1) || !(one.p < 2) || !(other.p < 2))
    return Error{"the first step found no oscillation"};
  const double omega = std::acos(cosine) / static_cast<double>(apart);
  const Sine found_u = second_step(samples.u, omega, one.q / (2 - one.p));
  const Sine found_v = second_step(samples.v, omega, other.q / (2 - other.p));
  const auto steps = static_cast<int>((gradient_passes + 1) * u.size());
  return PeerAnswer{from_unit(parameters_of_sines(found_u, found_v), samples.scale), steps};
}

Result<PeerAnswer> in_order(Peer peer, const Channel& u, const Channel& v) {
  const Result<Turns> turns = whole_turns(u);
  if (!turns) return Error{turns.error()};
  const Turns& t = turns.value();
  if (peer == Peer::fourier)
    return PeerAnswer{parameters_of_sines(fourier_line(u, t), fourier_line(v, t)), 0};
  if (peer == Peer::two_step) return two_steps(u, v, t);
  const double omega = two_pi / t.length;
  return PeerAnswer{parameters_of_sines(observe(u, omega), observe(v, omega)),
                    static_cast<int>(u.size())};
}

}  // namespace

const char* to_string(Peer peer) {
  constexpr const char* names[] = {"sgd", "momentum", "rls", "fourier", "observer", "two-step"};
  return names[static_cast<int>(peer)];
}

bool needs_order(Peer peer) {
  return peer == Peer::fourier || peer == Peer::observer || peer == Peer::two_step;
}

Result<PeerAnswer> identify_by(Peer peer, const Channel& u, const Channel& v, uint64_t seed) {
  if (auto error = check_samples(u, v)) return *error;
  if (needs_order(peer)) return in_order(peer, u, v);
  switch (peer) {
    case Peer::gradient:
      return descend(u, v, 0.1, 0, seed);
    case Peer::momentum:
      return descend(u, v, 0.02, 0.9, seed);
    default:
      return recursive_least_squares(u, v);
  }
}

}  // namespace capsoc::identification
