#include "identification/gates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "identification/distributions.h"
#include "identification/fused_network.h"
#include "identification/robust_fit.h"
#include "identification/sentence.h"

namespace capsoc::identification {
namespace {

Gate at_least(const char* name, double value, double limit, std::string reason) {
  const bool passed = value >= limit;
  return {name, passed, value, limit, passed ? std::string() : std::move(reason)};
}

Gate at_most(const char* name, double value, double limit, std::string reason) {
  const bool passed = value <= limit;
  return {name, passed, value, limit, passed ? std::string() : std::move(reason)};
}

/// Mean distance of a plateau inside the ellipse that is not by chance, in its standard errors.
constexpr double plateau_limit = 5;

/// How many samples have the largest value, and how many the next smaller one.
struct Pile {
  Eigen::Index top = 0, next = 0;
};

/// With sign -1: the smallest value and the next larger one.
Pile pile_of(const Channel& channel, double sign) {
  double top = sign * channel[0], next = -HUGE_VAL;
  Pile pile;
  for (const double value : channel) {
    const double x = sign * value;
    if (x > top) {
      next = top;
      pile.next = pile.top;
      top = x;
      pile.top = 1;
    } else if (x == top) {
      ++pile.top;
    } else if (x > next) {
      next = x;
      pile.next = 1;
    } else if (x == next) {
      ++pile.next;
    }
  }
  return pile;
}

/// A pile must be this many samples, and this many times as large as a sine's peak can be.
constexpr Eigen::Index least_pile = 8;
constexpr double by_sine = 1.66;
/// Converters' records without clipping that have a pile, at each depth.
constexpr double pile_false_alarms = 1e-5;

bool large_enough(Eigen::Index top, Eigen::Index count) {
  return top >= least_pile && 100 * top >= count;
}

/// For samples that no converter rounded: equal values are rare among them. A sine whose peak lies
/// anywhere within its last step has at most 1/(sqrt 2 - 1) = 2.4 times the samples of the step
/// below in that step. Four times the samples mean a flat top.
bool piled_up(const Pile& pile, Eigen::Index count) {
  return large_enough(pile.top, count) &&
         static_cast<double>(pile.top) >
             by_sine * 2.4142135623730951 * static_cast<double>(pile.next);
}

/// The same with the converter's step known: of a sine's samples in the last 1 + depth steps at
/// most 1/sqrt(1 + depth) are in the last one. Few samples can exceed that by chance, so it has to
/// be exceeded by more than chance explains. Samples that repeat are one: they are not independent.
bool piled_up(const Channel& channel, const Channel& other, double sign, double step) {
  const double top = (sign * channel).maxCoeff();
  constexpr std::array<int, 4> depths = {1, 4, 16, 64};
  std::vector<std::pair<double, double>> near;  // depth below the top in steps, and the other value
  Eigen::Index equal = 0;
  for (Eigen::Index i = 0; i < channel.size(); ++i) {
    const double depth = std::round((top - sign * channel[i]) / step);
    if (depth > depths.back()) continue;
    near.emplace_back(depth, other[i]);
    equal += depth == 0 ? 1 : 0;
  }
  if (!large_enough(equal, channel.size())) return false;
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  const auto within = [&](double depth) {
    const auto end = std::upper_bound(near.begin(), near.end(), std::make_pair(depth, HUGE_VAL));
    return static_cast<double>(end - near.begin());
  };
  const double last = within(0);
  if (last < static_cast<double>(least_pile)) return false;
  return std::any_of(depths.begin(), depths.end(), [&](int depth) {
    const double part = 1 / std::sqrt(1.0 + depth), all = within(depth);
    return last > by_sine * part / (1 - part) * (all - last) &&
           binomial_tail(last, all, part) < pile_false_alarms;
  });
}

Gate check_clipping(const Channel& u, const Channel& v, double full_scale, double step) {
  Gate gate = {"clipping", true, 0, 0, ""};
  if (full_scale > 0) {
    const auto clipped =
        static_cast<double>((u.abs() >= full_scale).count() + (v.abs() >= full_scale).count());
    gate.value = clipped;
    if (clipped > 0) {
      gate.passed = false;
      gate.reason = text("%.0f values are at or beyond full scale: lower the gain", clipped);
      return gate;
    }
  }
  for (const bool is_u : {true, false}) {
    for (const double sign : {1.0, -1.0}) {
      const Channel &channel = is_u ? u : v, &other = is_u ? v : u;
      const Pile pile = pile_of(channel, sign);
      if (step > 0 ? !piled_up(channel, other, sign, step) : !piled_up(pile, channel.size()))
        continue;
      const auto share = static_cast<double>(pile.top) / static_cast<double>(channel.size());
      gate.passed = false;
      gate.value = std::max(gate.value, static_cast<double>(pile.top));
      gate.reason = std::string("channel ") + (is_u ? "U" : "V") +
                    " is clipped: " + text("%.1f %% of its samples have its ", 100 * share) +
                    (sign > 0 ? "largest" : "smallest") + " value; lower the gain";
      return gate;
    }
  }
  return gate;
}

}  // namespace

Gate failed_gate(const char* name, std::string reason) {
  return {name, false, 0, 0, std::move(reason)};
}

std::vector<Gate> check_record(const Channel& u, const Channel& v, const GateLimits& limits,
                               double step) {
  std::vector<Gate> gates;
  const auto count = static_cast<double>(std::min(u.size(), v.size()));
  gates.push_back(at_least("samples", count, static_cast<double>(limits.samples),
                           text("%.0f samples are too few: record at least %.0f", count,
                                static_cast<double>(limits.samples))));
  if (!gates.back().passed) return gates;
  const auto error = check_samples(u, v);
  const bool finite = !error || error->text.find("finite") == std::string::npos;
  gates.push_back({"finite", finite, 0, 0, finite ? "" : error->text});
  if (!finite) return gates;
  gates.push_back({"ellipse", !error, 0, 0, error ? error->text : ""});
  if (error) return gates;
  gates.push_back(check_clipping(u, v, limits.full_scale, step));
  return gates;
}

std::vector<Plateau> plateaus_of(const Channel& u, const Channel& v, double resolution) {
  std::vector<Plateau> plateaus;
  for (const bool is_u : {true, false}) {
    for (const double sign : {1.0, -1.0}) {
      const Channel &channel = is_u ? u : v, &other = is_u ? v : u;
      const double extreme = sign * (sign * channel).maxCoeff();
      Plateau plateau{is_u ? "U" : "V", sign > 0, {}};
      double least = HUGE_VAL, largest = -HUGE_VAL;
      for (Eigen::Index i = 0; i < channel.size(); ++i) {
        if (std::abs(channel[i] - extreme) > 1.01 * resolution) continue;
        plateau.places.push_back(i);
        least = std::min(least, other[i]);
        largest = std::max(largest, other[i]);
      }
      if (plateau.places.size() >= 2 && largest > least) plateaus.push_back(std::move(plateau));
    }
  }
  return plateaus;
}

Gate check_plateau(const Channel& u, const Channel& v, const Plateau& plateau,
                   const Parameters& parameters, double noise, double resolution) {
  double inward = 0;
  for (const Eigen::Index i : plateau.places) inward -= distance_from(parameters, u[i], v[i]);
  const auto count = static_cast<double>(plateau.places.size());
  // What an unknown converter's steps do to all samples of a plateau alike is up to half a step,
  // and the noise of such a record is the steps' 0.29 and more.
  const double error = std::hypot(noise * std::max(1 / std::sqrt(count), 0.5), resolution);
  Gate gate = at_most("plateau", inward / count / std::max(error, 1e-300), plateau_limit, "");
  if (!gate.passed) {
    gate.reason =
        "channel " + plateau.name + " is clipped: " + text("%.0f samples share its ", count) +
        (plateau.top ? "largest" : "smallest") +
        text(" value, %.2g inside the ellipse of the others; lower the gain", inward / count);
  }
  return gate;
}

std::vector<Gate> check_answer(const Channel& u, const Channel& v, const Parameters& parameters,
                               const GateLimits& limits) {
  std::vector<Gate> gates;
  const Coverage coverage = coverage_of(u, v, parameters);
  gates.push_back(at_least("coverage", coverage.part, limits.coverage,
                           text("the samples cover %.0f %% of the turn and %.0f %% are needed: "
                                "turn the sensor further while recording",
                                100 * coverage.part, 100 * limits.coverage)));
  gates.push_back(at_most("gap", coverage.largest_gap, limits.gap,
                          text("%.1f degrees of the turn have no sample and at most %.1f may be "
                               "missing: turn the sensor further while recording",
                               coverage.largest_gap, limits.gap)));
  gates.push_back(at_most("phase", std::abs(parameters.beta), limits.phase,
                          text("beta is %.4f rad, the channels are all but in phase (at most "
                               "%.2f): check the sensor's mounting",
                               parameters.beta, limits.phase)));
  const double larger = std::max(2 * parameters.a1 / (u.maxCoeff() - u.minCoeff()),
                                 2 * parameters.a2 / (v.maxCoeff() - v.minCoeff()));
  gates.push_back(at_most("magnification", larger, limits.magnification,
                          text("the fitted ellipse is %.0f times as large as the range of the "
                               "samples (at most %.0f): record more of the turn",
                               larger, limits.magnification)));
  const double residual = std::sqrt(FusedNetwork().loss(to_nodes(parameters), u, v));
  gates.push_back(at_most("residual", residual, limits.residual,
                          text("the samples scatter by %.2g of the amplitude about the ellipse (at "
                               "most %.2g): these are not a sine and a cosine of one angle",
                               residual, limits.residual)));
  return gates;
}

}  // namespace capsoc::identification
