#include "fit/certainty_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include "base/constants.h"
#include "fit/drawn_records.h"
#include "fit/hard_records.h"
#include "identification/circle_plane.h"
#include "identification/identify.h"

namespace capsoc::fit {
namespace {

identification::IdentifyOptions options_for(const DrawnRecord& record) {
  identification::IdentifyOptions options;
  options.step = record.step;
  return options;
}

struct Coverage {
  int wanted = 0, accepted = 0;
  std::array<int, 5> held{};
};

void count_held(const identification::Identification& found,
                const identification::Parameters& truth, Coverage& coverage) {
  const identification::Parameters& p = found.network_parameters;
  const identification::Intervals& half = found.intervals;
  const std::array<double, 5> error = {p.a1 - truth.a1, p.a2 - truth.a2, p.b1 - truth.b1,
                                       p.b2 - truth.b2, p.beta - truth.beta};
  const std::array<double, 5> width = {half.a1, half.a2, half.b1, half.b2, half.beta};
  ++coverage.accepted;
  for (std::size_t k = 0; k < 5; ++k) coverage.held[k] += std::abs(error[k]) <= width[k] ? 1 : 0;
}

const identification::Gate* failed_gate(const identification::Identification& found) {
  for (const identification::Gate& gate : found.gates)
    if (!gate.passed) return &gate;
  return nullptr;
}

/// Whether what the gate says is so, by what is known of the record.
bool is_true(const identification::Gate& gate, const DrawnRecord& record) {
  const bool no_ellipse = record.kind == RecordKind::dead || record.kind == RecordKind::constant ||
                          record.kind == RecordKind::equal;
  if (no_ellipse) return true;
  const double slope = identification::CirclePlane(record.truth).largest_slope();
  const double noise = record.noise * slope;
  const auto count = static_cast<double>(record.samples.u.size());
  if (gate.name == "outliers") return record.outside > 0.15;
  if (gate.name == "clipping" || gate.name == "plateau") return record.clipped >= 2;
  if (gate.name == "noise") return noise > 0.2 || record.outside > 0.3;
  if (gate.name == "coverage" || gate.name == "gap") {
    const identification::Coverage there =
        identification::coverage_of(record.samples.u, record.samples.v, record.truth);
    return there.part < 0.55 || there.largest_gap > 135;
  }
  // Too little to tell the angle: an arc, few samples or noise. Five parameters know the angle to
  // some five times noise/sqrt(N), of an arc far worse.
  const bool arc = record.kind == RecordKind::arc || record.clipped > 0 || record.outside > 0.3;
  if (gate.name == "bound" || gate.name == "distances" || gate.name == "ellipse" ||
      gate.name == "magnification" || gate.name == "phase")
    return arc || noise > 0.15 || 40 * noise / std::sqrt(count) > 20 * radians_per_degree;
  return false;
}

struct Verdicts {
  int right = 0, said = 0, wrong = 0, refused = 0, falsely = 0;
  double inside = 0;  ///< largest ratio of error and bound
  std::vector<double> ratios;
  std::vector<double> of_parameters;  ///< against the bound of the parameters alone
};

std::string judge(const DrawnRecord& record, Verdicts& verdicts) {
  const auto result = identification::identify(record.samples, options_for(record));
  if (!result) return result.error();
  const identification::Identification& found = result.value();
  if (const identification::Gate* gate = failed_gate(found)) {
    const bool good = is_true(*gate, record);
    ++(good ? verdicts.refused : verdicts.falsely);
    return good ? "" : "refused: " + gate->reason;
  }
  if (!found.bound) {
    const bool good = record.kind == RecordKind::harmonics || record.clipped > 0;
    ++(good ? verdicts.said : verdicts.falsely);
    return good ? "" : found.warning;
  }
  const double error =
      record.kind == RecordKind::dead ? HUGE_VAL : angle_error_of(record, found.network_parameters);
  const double ratio = error / found.bound->total;
  verdicts.ratios.push_back(ratio);
  verdicts.of_parameters.push_back(error / found.bound->parameters);
  if (ratio <= 1) {
    ++verdicts.right;
    return "";
  }
  ++verdicts.wrong;
  return fmt::format("{} samples, noise {:.1e}: {:.3g} deg wrong, {:.3g} stated",
                     record.samples.u.size(), record.noise, error / radians_per_degree,
                     found.bound->total / radians_per_degree);
}

/// The shares of a row, and whether they are what they should be.
bool print_held(std::ostream& out, const Coverage& coverage) {
  const double accepted = std::max(coverage.accepted, 1);
  double sum = 0;
  for (const int held : coverage.held) {
    out << fmt::format(" {:7.1f}", 100 * held / accepted);
    sum += 20 * held / accepted;
  }
  // The five intervals of a record depend on each other: they count as two.
  const double error = 100 * std::sqrt(0.95 * 0.05 / (2 * accepted));
  const bool good = coverage.accepted == 0 || std::abs(sum - 95) <= 2 + 3 * error;
  out << fmt::format(" {:7.1f}{}\n", sum, good ? "" : "  MISSED");
  return good;
}

int print_hard_coverage(std::ostream& out, int records, uint64_t from) {
  int missed = 0;
  out << fmt::format(
      "\nThe same for records as people make them; none: accepted without intervals, and why is "
      "said; 200 to 2,000 samples\n{:26} {:>8} {:>7} {:>5} {:>8} {:>7} {:>7} {:>7} {:>7} {:>7} "
      "{:>7}\n",
      "record", "records", "refused", "none", "interval", "a1", "a2", "b1", "b2", "beta", "all");
  for (const HardKind& kind : hard_kinds()) {
    Random random(from);
    Coverage coverage;
    coverage.wanted = records;
    int refused = 0, none = 0;
    for (int i = 0; i < records; ++i) {
      const DrawnRecord record = kind.draw(random);
      const auto found = identification::identify(record.samples, options_for(record));
      if (!found || found.value().rejected())
        ++refused;
      else if (!found.value().no_intervals.empty() || found.value().structure.found)
        ++none;
      else
        count_held(found.value(), record.truth, coverage);
    }
    out << fmt::format("{:26} {:8} {:7} {:5} {:8}", kind.name, records, refused, none,
                       coverage.accepted);
    missed += print_held(out, coverage) ? 0 : 1;
  }
  return missed;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

int print_coverage(std::ostream& out, int records, uint64_t from) {
  int missed = 0;
  out << fmt::format(
      "\n95 % intervals that hold the truth, %: random sensors at random angles, noise relative to "
      "the smaller amplitude, seed {}\n{:>8} {:>8} {:>8} {:>8} {:>7} {:>7} {:>7} {:>7} {:>7} "
      "{:>7}\n",
      from, "noise", "samples", "records", "accepted", "a1", "a2", "b1", "b2", "beta", "all");
  for (const double noise : {1e-4, 1e-3, 1e-2, 3e-2}) {
    for (const Eigen::Index count : {20, 100, 1000, 20000}) {
      Random random(from + static_cast<uint64_t>(count));
      Coverage coverage;
      coverage.wanted = count > 10000 ? std::max(records / 5, 1) : records;
      for (int i = 0; i < coverage.wanted; ++i) {
        const DrawnRecord record = draw_good_record(random, noise, count);
        const auto found = identification::identify(record.samples, options_for(record));
        if (!found || found.value().rejected()) continue;
        if (found.value().no_intervals.empty()) count_held(found.value(), record.truth, coverage);
      }
      out << fmt::format("{:8.0e} {:8} {:8} {:8}", noise, count, coverage.wanted,
                         coverage.accepted);
      missed += print_held(out, coverage) ? 0 : 1;
    }
  }
  return missed + print_hard_coverage(out, records, from);
}

int print_bounds(std::ostream& out, int sensors, uint64_t from) {
  int missed = 0;
  out << fmt::format(
      "\nStated bound over the largest true error of the angle over the turn: random sensors "
      "without "
      "harmonics, {} a row, seed {}\n{:26} {:>8} {:>9} {:>7} {:>8} {:>8} {:>8} {:>16}\n",
      sensors, from, "record", "accepted", "no bound", "over", "median", "95 %", "least",
      "whole, median");
  for (const RecordKind kind : {RecordKind::good, RecordKind::tiny, RecordKind::converter}) {
    Random random(from);
    std::vector<double> ratios, whole;
    int none = 0, over = 0;
    for (int i = 0; i < sensors; ++i) {
      const DrawnRecord record = draw_record(random, kind);
      const auto found = identification::identify(record.samples, options_for(record));
      if (!found || found.value().rejected() || !found.value().bound) {
        ++none;
        continue;
      }
      const double error = angle_error_of(record, found.value().network_parameters);
      ratios.push_back(found.value().bound->parameters / error);
      whole.push_back(found.value().bound->total / error);
      over += ratios.back() < 1 ? 1 : 0;
    }
    missed += over;
    std::sort(ratios.begin(), ratios.end());
    const auto at = [&](double share) {
      return ratios.empty()
                 ? 0
                 : ratios[static_cast<std::size_t>(share * static_cast<double>(ratios.size() - 1))];
    };
    out << fmt::format("{:26} {:8} {:9} {:7} {:8.2f} {:8.2f} {:8.2f} {:16.2f}{}\n", to_string(kind),
                       ratios.size(), none, over, at(0.5), at(0.95), at(0), median(whole),
                       over == 0 ? "" : "  MISSED");
  }
  out << "median, 95 %, least: of the bound without harmonics; whole: with what the residuals "
         "leave "
         "room for\n";
  return missed;
}

int print_allowance(std::ostream& out, int sensors) {
  struct Row {
    const char* name;
    int least, highest;
    bool both, claimed;
  };
  constexpr Row rows[] = {{"orders 2 to 5, U and V", 2, 5, true, true},
                          {"order 2, U and V", 2, 2, true, false},
                          {"order 3, U and V", 3, 3, true, false},
                          {"order 2, U alone", 2, 2, false, false},
                          {"order 3, U alone", 3, 3, false, false}};
  constexpr Eigen::Index count = 1000;
  int missed = 0;
  out << fmt::format(
      "\nThe angle's error in units of the harmonics' amplitude that {} samples show; the bound "
      "takes {:g} of it ({} random sensors a row, seed {})\n{:26} {:>8} {:>10} {:>8} {:>13}\n",
      count, identification::angle_by_amplitude, sensors, seed, "harmonics", "median", "99 % below",
      "largest", "the bound's, %");
  for (const Row& row : rows) {
    Random random(seed);
    std::vector<double> ratios;
    for (int i = 0; i < sensors; ++i) {
      const DrawnRecord record =
          draw_harmonic_record(random, row.least, row.highest, row.both, count);
      const auto found = identification::identify(record.samples);
      if (!found || found.value().rejected()) continue;
      ratios.push_back(angle_error_of(record, found.value().network_parameters) /
                       std::max(found.value().structure.amplitude, 1e-300));
    }
    std::sort(ratios.begin(), ratios.end());
    const auto all = static_cast<double>(sensors);
    const auto held = static_cast<double>(
        std::upper_bound(ratios.begin(), ratios.end(), identification::angle_by_amplitude) -
        ratios.begin());
    const auto place = static_cast<std::size_t>(0.99 * static_cast<double>(ratios.size()));
    const bool good = !row.claimed || held >= 0.95 * all;
    missed += good ? 0 : 1;
    out << fmt::format("{:26} {:8.2f} {:10.2f} {:8.1f} {:13.1f}{}\n", row.name, median(ratios),
                       ratios.empty() ? 0 : ratios[place], ratios.empty() ? 0 : ratios.back(),
                       100 * held / all, good ? "" : "  MISSED");
  }
  return missed;
}

int print_drawn(std::ostream& out, int records) {
  int missed = 0;
  Random random(seed);
  std::array<Verdicts, record_kinds> verdicts;
  std::array<std::vector<std::string>, record_kinds> wrong;
  for (int i = 0; i < records; ++i) {
    // Half of the records are good ones, the others of all kinds in turn.
    const int kind = i % 2 == 0 ? 0 : i / 2 % record_kinds;
    const DrawnRecord record = draw_record(random, static_cast<RecordKind>(kind));
    const std::string text = judge(record, verdicts.at(static_cast<std::size_t>(kind)));
    if (!text.empty()) wrong.at(static_cast<std::size_t>(kind)).push_back(text);
  }
  out << fmt::format(
      "\n{} random records, seed {}: the angle's error over the turn within the bound that is "
      "stated, or a reason that is true\n{:26} {:>8} {:>10} {:>7} {:>9} {:>8} {:>13} {:>8} {:>12} "
      "{:>8}\n",
      records, seed, "record", "accepted", "harmonics", "over", "refused", "falsely", "error/bound",
      "largest", "/parameters", "largest");
  for (std::size_t kind = 0; kind < record_kinds; ++kind) {
    const Verdicts& v = verdicts.at(kind);
    const double largest =
        v.ratios.empty() ? 0 : *std::max_element(v.ratios.begin(), v.ratios.end());
    const double of_parameters =
        v.of_parameters.empty() ? 0
                                : *std::max_element(v.of_parameters.begin(), v.of_parameters.end());
    missed += static_cast<int>(wrong.at(kind).size());
    out << fmt::format("{:26} {:8} {:10} {:7} {:9} {:8} {:13.2f} {:8.2f} {:12.2f} {:8.2f}{}\n",
                       to_string(static_cast<RecordKind>(kind)), v.right, v.said, v.wrong,
                       v.refused, v.falsely, median(v.ratios), largest, median(v.of_parameters),
                       of_parameters, wrong.at(kind).empty() ? "" : "  MISSED");
    for (const std::string& text : wrong.at(kind)) out << "    " << text << "\n";
  }
  out << "accepted: with a bound that holds; harmonics: accepted, found and said, no bound; over: "
         "the error is larger than the bound; falsely: refused, or harmonics said, without cause\n"
         "error/bound: of the whole bound, median and largest; /parameters: of the part without "
         "harmonics that may hide\n";
  return missed;
}

}  // namespace capsoc::fit
