#include "fit/drawn_records.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace capsoc::fit {
namespace {

double between(Random& random, double least, double largest) {
  return least + (largest - least) * random.uniform();
}

double log_between(Random& random, double least, double largest) {
  return least * std::pow(largest / least, random.uniform());
}

identification::Parameters draw_sensor(Random& random) {
  identification::Parameters p;
  p.a1 = between(random, 0.1, 0.9);
  p.a2 = std::clamp(p.a1 * log_between(random, 0.5, 2), 0.1, 0.9);
  p.b1 = between(random, -0.3, 0.3);
  p.b2 = between(random, -0.3, 0.3);
  p.beta = between(random, -1, 1);
  return p;
}

void draw_harmonics(Random& random, DrawnRecord& record) {
  const double size = log_between(random, 1e-3, 3e-2);
  for (auto* channel : {&record.u, &record.v}) {
    for (identification::HarmonicTerm& term : *channel) {
      const double amplitude = size * random.uniform(), phase = 2 * pi * random.uniform();
      term = {amplitude * std::cos(phase), amplitude * std::sin(phase)};
    }
  }
}

void take_samples(Random& random, DrawnRecord& record, Eigen::Index count, double turns) {
  record.samples = {Eigen::ArrayXd(count), Eigen::ArrayXd(count)};
  record.theta.resize(count);
  const double origin = 2 * pi * random.uniform();
  for (Eigen::Index i = 0; i < count; ++i) {
    record.theta[i] = origin + 2 * pi * turns * random.uniform();
    const identification::Point at = point_of(record, record.theta[i]);
    record.samples.u[i] = at.u + record.noise * normal(random);
    record.samples.v[i] = at.v + record.noise * normal(random);
  }
}

void disturb(Random& random, DrawnRecord& record) {
  const Eigen::Index count = record.samples.u.size();
  identification::Samples& samples = record.samples;
  switch (record.kind) {
    case RecordKind::converter:
      record.step = std::ldexp(1.0, -static_cast<int>(between(random, 9, 16)));
      samples.u = (samples.u / record.step).round() * record.step;
      samples.v = (samples.v / record.step).round() * record.step;
      break;
    case RecordKind::outliers: {
      record.outside = log_between(random, 0.004, 0.45);
      const auto disturbed =
          static_cast<Eigen::Index>(std::ceil(record.outside * static_cast<double>(count)));
      record.outside = static_cast<double>(disturbed) / static_cast<double>(count);
      for (Eigen::Index i = 0; i < disturbed; ++i) {  // the angles are in no order
        samples.u[i] = between(random, -1, 1);
        samples.v[i] = between(random, -1, 1);
      }
      break;
    }
    case RecordKind::clipped: {
      const double level = record.truth.b1 + between(random, 0.4, 0.98) * record.truth.a1;
      record.clipped = static_cast<int>((samples.u > level).count());
      samples.u = samples.u.min(level);
      break;
    }
    case RecordKind::constant:
      samples.v.setConstant(record.truth.b2);
      for (double& value : samples.v) value += record.noise * normal(random);
      break;
    case RecordKind::equal: {
      const double sign = random.uniform() < 0.5 ? 1 : -1;
      samples.v = sign * samples.u;
      for (double& value : samples.v) value += record.noise * normal(random);
      break;
    }
    default:
      break;
  }
}

}  // namespace

const char* to_string(RecordKind kind) {
  static constexpr const char* names[] = {"good",
                                          "arc of 10 .. 90 %",
                                          "amplitude 5e-4 .. 5e-3",
                                          "offset to 20 amplitudes",
                                          "10 .. 16 bits",
                                          "outliers",
                                          "clipped",
                                          "harmonics",
                                          "dead",
                                          "V constant",
                                          "V = U or -U"};
  return names[static_cast<int>(kind)];
}

identification::Point point_of(const DrawnRecord& record, double theta) {
  identification::Point at = identification::point_at({record.truth, {}, {}}, theta);
  for (std::size_t k = 0; k < record.u.size(); ++k) {
    const double order = static_cast<double>(k) + 2;
    const double sine = std::sin(order * theta), cosine = std::cos(order * theta);
    at.u += record.truth.a1 * (record.u[k].sine * sine + record.u[k].cosine * cosine);
    at.v += record.truth.a2 * (record.v[k].sine * sine + record.v[k].cosine * cosine);
  }
  return at;
}

DrawnRecord draw_good_record(Random& random, double noise, Eigen::Index count) {
  DrawnRecord record;
  record.truth = draw_sensor(random);
  record.noise = noise * std::min(record.truth.a1, record.truth.a2);
  take_samples(random, record, count, 1);
  return record;
}

DrawnRecord draw_harmonic_record(Random& random, int least, int highest, bool both,
                                 Eigen::Index count) {
  DrawnRecord record;
  record.kind = RecordKind::harmonics;
  record.truth = draw_sensor(random);
  for (auto* channel : {&record.u, &record.v}) {
    for (int order = least; order <= highest && (both || channel == &record.u); ++order) {
      const double amplitude = 1e-3 * random.uniform(), phase = 2 * pi * random.uniform();
      channel->at(static_cast<std::size_t>(order) - 2) = {amplitude * std::cos(phase),
                                                          amplitude * std::sin(phase)};
    }
  }
  take_samples(random, record, count, 1);
  return record;
}

DrawnRecord draw_record(Random& random, RecordKind kind) {
  DrawnRecord record;
  record.kind = kind;
  identification::Parameters& p = record.truth;
  p = draw_sensor(random);
  if (kind == RecordKind::tiny || kind == RecordKind::offset) {
    const double scale = kind == RecordKind::tiny ? log_between(random, 1e-3, 1e-2) : 0.05;
    p.a1 *= scale;
    p.a2 *= scale;
  }
  record.noise = log_between(random, 1e-4, 3e-2) * std::min(p.a1, p.a2);
  if (kind == RecordKind::dead) p.a1 = p.a2 = 0;
  if (kind == RecordKind::harmonics) draw_harmonics(random, record);
  const auto count = static_cast<Eigen::Index>(log_between(random, 20, 20000));
  take_samples(random, record, count, kind == RecordKind::arc ? between(random, 0.1, 0.9) : 1);
  disturb(random, record);
  return record;
}

double angle_error_of(const DrawnRecord& record, const identification::Parameters& parameters) {
  constexpr int points = 360;
  double largest = 0;
  for (int i = 0; i < points; ++i) {
    const double theta = 2 * pi * i / points;
    const identification::Point at = point_of(record, theta);
    const double error =
        identification::wrapped(identification::angle_of(parameters, at.u, at.v) - theta);
    largest = std::max(largest, std::abs(error));
  }
  return largest;
}

double normal(Random& random) {
  // Box and Muller; the same bytes wherever the C library's functions round alike.
  const double radius = std::sqrt(-2 * std::log(1 - random.uniform()));
  return radius * std::cos(2 * pi * random.uniform());
}

}  // namespace capsoc::fit
