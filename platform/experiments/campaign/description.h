// The description of a campaign: a TOML file (docs/guide/campaigns.md). It knows no settings:
// whether one exists and what it may be is for the kind of work to say (work.h).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "campaign/axis.h"
#include "campaign/expression.h"
#include "workers/engine.h"

namespace capsoc::campaign {

/// More than this is a mistake, or a job for several campaigns.
constexpr uint64_t most_runs = 1'000'000;

/// Axes that are combined with each other. The groups make a product.
struct AxisGroup {
  enum class Combine {
    product,          ///< every value with every other; the last axis changes first
    zip,              ///< the first values together, the second ones, ...
    independent,      ///< `runs` draws of each axis
    latin_hypercube,  ///< the same, each axis in equal shares with one draw in each
  };
  Combine combine = Combine::product;
  uint64_t runs = 0;  ///< of the whole group
  std::vector<Axis> axes;

  bool is_sample() const {
    return combine == Combine::independent || combine == Combine::latin_hypercube;
  }
};

/// An expression with a name.
struct Named {
  std::string name;
  Expression expression;
  std::string origin;
};

struct Description {
  std::string file, text;
  std::string name, kind = "run";
  uint64_t seed = 1;  ///< of all that is drawn
  std::vector<Assignment> settings;
  std::vector<AxisGroup> groups;
  uint64_t repetitions = 1;
  std::vector<Assignment> repetition_seeds;  ///< settings that get another seed in each; no values
  std::vector<Named> derived;                ///< settings that follow from others
  workers::Limits limits;
  std::string failures_folder;  ///< where the recordings of failed runs go; "": nowhere
  bool failures_waves = false;
  std::optional<double> session_s;  ///< failed runs as sessions, too, of the last simulated seconds
  std::vector<Named> metrics, criteria;
  std::vector<Named> by;  ///< what the report tells apart
  double least_yield = 1;
  std::string worst;  ///< the metric whose largest values are the worst; "": the first one

  /// Product of the groups and repetitions, at most most_runs.
  uint64_t runs() const;
  /// The paths of all axes in order, repetition_seeds last.
  std::vector<std::string> axis_paths() const;
};

/// Error: "file:line: what is wrong; what to do".
Result<Description> read_description(const std::string& file);
/// From a text that `file` once had.
Result<Description> read_description(const std::string& text, const std::string& file);

}  // namespace capsoc::campaign
