#include "fit/hard_records.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "base/constants.h"

namespace capsoc::fit {
namespace {

using Angle = std::function<double(Eigen::Index)>;
using Noise = std::function<std::array<double, 2>()>;

constexpr Eigen::Index usual = 1000;

double uniform_within(Random& random, double least, double largest) {
  return least + (largest - least) * random.uniform();
}

/// A sensor with a noise of 1e-4 to 1e-2 of its smaller amplitude.
DrawnRecord draw_sensor_with_noise(Random& random) {
  DrawnRecord record = draw_good_record(random, 1, 1);
  record.noise *= 1e-4 * std::pow(100.0, random.uniform());
  return record;
}

void take(DrawnRecord& record, Eigen::Index count, const Angle& angle, const Noise& noise) {
  record.samples = {Eigen::ArrayXd(count), Eigen::ArrayXd(count)};
  record.theta.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    record.theta[i] = angle(i);
    const identification::Point at = point_of(record, record.theta[i]);
    const std::array<double, 2> added = noise();
    record.samples.u[i] = at.u + record.noise * added[0];
    record.samples.v[i] = at.v + record.noise * added[1];
  }
}

Noise white(Random& random) {
  return [&random]() -> std::array<double, 2> {
    const double u = normal(random);
    return {u, normal(random)};
  };
}

/// 2.3 to 40 turns in order of time.
Angle turning(Random& random, Eigen::Index count) {
  const double turns = 2.3 * std::pow(40 / 2.3, random.uniform()),
               origin = 2 * pi * random.uniform();
  return [=](Eigen::Index i) {
    return origin + 2 * pi * turns * static_cast<double>(i) / static_cast<double>(count);
  };
}

Angle anywhere(Random& random) {
  return [&random](Eigen::Index) { return 2 * pi * random.uniform(); };
}

/// Autoregressive noise of variance 1 in both channels.
class Remembering {
 public:
  Remembering(Random& random, double keeps) : random_(&random), keeps_(keeps) {
    for (double& one : state_) one = normal(random);
  }
  std::array<double, 2> next() {
    for (double& one : state_)
      one = keeps_ * one + std::sqrt(1 - keeps_ * keeps_) * normal(*random_);
    return state_;
  }

 private:
  Random* random_;
  double keeps_;
  std::array<double, 2> state_{};
};

DrawnRecord with_memory(Random& random, double keeps, bool in_order) {
  DrawnRecord record = draw_sensor_with_noise(random);
  Remembering noise(random, keeps);
  take(record, usual, in_order ? turning(random, usual) : anywhere(random),
       [&noise] { return noise.next(); });
  return record;
}

/// Parts of equal power with memories of 1/2 to 2,048 samples: more than the record has.
DrawnRecord flicker(Random& random) {
  DrawnRecord record = draw_sensor_with_noise(random);
  std::vector<Remembering> parts;
  double memory = 0.5;
  while (memory < 4000) {
    parts.emplace_back(random, std::exp(-1 / memory));
    memory *= 4;
  }
  take(record, usual, turning(random, usual), [&parts]() -> std::array<double, 2> {
    std::array<double, 2> sum{};
    for (Remembering& part : parts) {
      const std::array<double, 2> one = part.next();
      for (std::size_t k = 0; k < 2; ++k)
        sum[k] += one[k] / std::sqrt(static_cast<double>(parts.size()));
    }
    return sum;
  });
  return record;
}

/// One offset or amplitude goes linearly through 0.1 to 10 times the noise.
DrawnRecord drifting(Random& random) {
  DrawnRecord record = draw_sensor_with_noise(random);
  const double size = record.noise * 0.1 * std::pow(100.0, random.uniform());
  const auto what = static_cast<int>(4 * random.uniform());
  take(record, usual, turning(random, usual), white(random));
  for (Eigen::Index i = 0; i < usual; ++i) {
    const double moved = size * (static_cast<double>(i) / (usual - 1) - 0.5);
    Eigen::ArrayXd& channel = what % 2 == 0 ? record.samples.u : record.samples.v;
    const double truth_offset = what % 2 == 0 ? record.truth.b1 : record.truth.b2;
    const double truth_amplitude = what % 2 == 0 ? record.truth.a1 : record.truth.a2;
    const identification::Point clean = point_of(record, record.theta[i]);
    const double sine = ((what % 2 == 0 ? clean.u : clean.v) - truth_offset) / truth_amplitude;
    channel[i] += what < 2 ? moved : moved * sine;
  }
  return record;
}

DrawnRecord indexed(Random& random, Eigen::Index positions, Eigen::Index each, int bits,
                    bool shuffled) {
  DrawnRecord record = draw_sensor_with_noise(random);
  const double origin = 2 * pi * random.uniform();
  const Angle angle = [&](Eigen::Index i) {
    const Eigen::Index place = shuffled ? random.index(positions) : i / each;
    return origin + 2 * pi * static_cast<double>(place) / static_cast<double>(positions);
  };
  take(record, positions * each, angle, white(random));
  if (bits == 0) return record;
  record.step = std::ldexp(1.0, 1 - bits);
  for (Eigen::ArrayXd* channel : {&record.samples.u, &record.samples.v})
    *channel = (*channel / record.step).round() * record.step;
  return record;
}

/// A swing over `degrees`, noise 1e-4 to 1e-3.
DrawnRecord arc(Random& random, double degrees) {
  DrawnRecord record = draw_good_record(random, 1, 1);
  record.noise *= 1e-4 * std::pow(10.0, random.uniform());
  const double middle = 2 * pi * random.uniform();
  const Angle angle = [=](Eigen::Index i) {
    return middle +
           degrees / 2 * radians_per_degree * std::sin(2 * pi * static_cast<double>(i) / 77.7);
  };
  take(record, 2 * usual, angle, white(random));
  return record;
}

/// 1 to 10 % of U's samples are 2 to 6 times the noise too large.
DrawnRecord one_sided(Random& random) {
  DrawnRecord record = draw_sensor_with_noise(random);
  take(record, usual, turning(random, usual), white(random));
  const double share = 0.01 * std::pow(10.0, random.uniform());
  for (double& value : record.samples.u)
    if (random.uniform() < share) value += record.noise * uniform_within(random, 2, 6);
  return record;
}

}  // namespace

const std::vector<HardKind>& hard_kinds() {
  using R = Random;
  static const std::vector<HardKind> kinds = {
      {"AR(1) 0.5, turning", [](R& r) { return with_memory(r, 0.5, true); }},
      {"AR(1) 0.5, random angles", [](R& r) { return with_memory(r, 0.5, false); }},
      {"AR(1) 0.9, turning", [](R& r) { return with_memory(r, 0.9, true); }},
      {"AR(1) 0.9, random angles", [](R& r) { return with_memory(r, 0.9, false); }},
      {"1/f, turning", flicker},
      {"drift 0.1 .. 10 noises", drifting},
      {"5 angles x 40", [](R& r) { return indexed(r, 5, 40, 0, false); }},
      {"8 angles x 20", [](R& r) { return indexed(r, 8, 20, 0, false); }},
      {"20 angles, shuffled", [](R& r) { return indexed(r, 20, 30, 0, true); }},
      {"50 angles x 20, 12 bits", [](R& r) { return indexed(r, 50, 20, 12, false); }},
      {"arc of 60 deg", [](R& r) { return arc(r, 60); }},
      {"arc of 90 deg", [](R& r) { return arc(r, 90); }},
      {"arc of 120 deg", [](R& r) { return arc(r, 120); }},
      {"arc of 150 deg", [](R& r) { return arc(r, 150); }},
      {"arc of 180 deg", [](R& r) { return arc(r, 180); }},
      {"arc of 210 deg", [](R& r) { return arc(r, 210); }},
      {"arc of 270 deg", [](R& r) { return arc(r, 270); }},
      {"arc of 350 deg", [](R& r) { return arc(r, 350); }},
      {"one-sided, 2 .. 6 noises", one_sided},
  };
  return kinds;
}

}  // namespace capsoc::fit
