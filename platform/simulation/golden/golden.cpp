#include "golden/golden.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "identification/calibration.h"
#include "identification/identify.h"

namespace capsoc::golden {
namespace {

constexpr double turn = 0x1p32 / (2 * pi);  ///< 2^-32 turn in a radian

identification::Samples to_samples(const metrics::SampleRecord& record) {
  const auto count = static_cast<Eigen::Index>(record.size());
  identification::Samples samples{Eigen::ArrayXd(count), Eigen::ArrayXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    samples.u[i] = record[static_cast<std::size_t>(i)].u / q31;
    samples.v[i] = record[static_cast<std::size_t>(i)].v / q31;
  }
  return samples;
}

identification::Parameters canonical_of(const metrics::ParameterWords& words) {
  const metrics::Parameters p = metrics::to_values(words);
  return identification::canonical({p.a1, p.a2, p.b1, p.b2, p.beta}).parameters;
}

std::optional<double> angle_difference(const identification::Parameters& soc,
                                       const identification::Parameters& csfn) {
  if (!(soc.a1 > 0 && soc.a2 > 0)) return std::nullopt;
  constexpr int points = 3600;
  double largest = 0;
  for (int i = 0; i < points; ++i) {
    const double theta = 2 * pi * i / points;
    const identification::Point point = identification::point_at({csfn}, theta);
    const double difference =
        identification::wrapped(identification::angle_of(soc, point.u, point.v) - theta);
    largest = std::max(largest, std::fabs(difference));
  }
  return largest * turn;
}

GoldenRow fraction_row(const char* name, double soc, double csfn, double interval) {
  const int64_t soc_word = std::llround(soc * q31), csfn_word = std::llround(csfn * q31);
  return {name, soc_word, csfn_word, soc_word - csfn_word, interval * q31};
}

GoldenRow angle_row(const char* name, double soc, double csfn, double interval) {
  const int64_t soc_word = std::llround(soc * turn), csfn_word = std::llround(csfn * turn);
  return {name, soc_word, csfn_word, static_cast<int32_t>(soc_word - csfn_word), interval * turn};
}

}  // namespace

Golden compare(const metrics::SampleRecord& record, const metrics::ParameterWords& words,
               const GoldenSettings& settings) {
  identification::IdentifyOptions options;
  options.method = identification::Method::levenberg_marquardt;
  options.gates.full_scale = 1;
  options.step = settings.converter_step;
  Golden golden;
  golden.samples = record.size();
  const identification::Samples samples = to_samples(record);
  auto identified = identification::identify(samples, options);
  if (identified && identified.value().rejected()) {
    options.method = identification::Method::distances;
    identified = identification::identify(samples, options);
  }
  golden.rejection = identified ? identified.value().rejection() : identified.error();
  if (!golden.rejection.empty()) {
    golden.angle.reason = "the CSFN refuses the samples: " + golden.rejection;
    return golden;
  }

  const identification::Identification& answer = identified.value();
  const identification::Parameters soc = canonical_of(words);
  const identification::Parameters& csfn = answer.parameters;
  const identification::Intervals& half = answer.intervals;
  golden.rows = {
      fraction_row("a1", soc.a1, csfn.a1, half.a1), fraction_row("a2", soc.a2, csfn.a2, half.a2),
      fraction_row("b1", soc.b1, csfn.b1, half.b1), fraction_row("b2", soc.b2, csfn.b2, half.b2),
      angle_row("beta", soc.beta, csfn.beta, half.beta)};
  golden.angle_difference = angle_difference(soc, csfn);
  golden.method = answer.method;
  golden.stop_reason = identification::to_string(answer.stopped);
  golden.iterations = answer.iterations;
  golden.confidence = half.confidence;
  golden.angle = compare_angles(record, answer, settings);
  return golden;
}

nlohmann::ordered_json to_json(const Golden& golden) {
  nlohmann::ordered_json j;
  j["samples"] = golden.samples;
  if (!golden.rejection.empty()) {
    j["rejection"] = golden.rejection;
    j["angle"] = to_json(golden.angle);
    return j;
  }
  j["method"] = identification::to_string(golden.method);
  j["stop_reason"] = golden.stop_reason;
  j["iterations"] = golden.iterations;
  j["confidence"] = golden.confidence;
  for (const GoldenRow& row : golden.rows)
    j["parameters"][row.name] = {{"soc", row.soc},
                                 {"csfn", row.csfn},
                                 {"difference", row.difference},
                                 {"interval", row.interval}};
  j["angle_difference"] =
      golden.angle_difference ? nlohmann::ordered_json(*golden.angle_difference) : nullptr;
  j["angle"] = to_json(golden.angle);
  return j;
}

std::string to_table(const Golden& golden) {
  if (!golden.rejection.empty())
    return fmt::format("\ngolden check: the CSFN refuses the {} samples: {}\n{}", golden.samples,
                       golden.rejection, to_table(golden.angle));
  std::string text =
      fmt::format("\n{:<10}{:>14}{:>14}{:>16}{:>16}\n", "golden", "SoC", "CSFN", "difference",
                  fmt::format("{:g} % interval", 100 * golden.confidence));
  for (const GoldenRow& row : golden.rows)
    text += fmt::format("{:<10}{:>14}{:>14}{:>16}{:>16.3g}\n", row.name, row.soc, row.csfn,
                        row.difference, row.interval);
  text +=
      fmt::format("differences in units of the last place, {} samples, CSFN: {} after {} steps\n",
                  golden.samples, golden.stop_reason, golden.iterations);
  if (golden.angle_difference)
    text += fmt::format("what the parameters alone make of it: {:.3g} of 2^-32 turn ({:.3g} deg)\n",
                        *golden.angle_difference, *golden.angle_difference / 0x1p32 * 360);
  return text + to_table(golden.angle);
}

}  // namespace capsoc::golden
