// An axis: a setting and the values that it takes in a campaign.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace capsoc::campaign {

/// A setting by its name, as `-C` has it, and a value as text.
struct Assignment {
  std::string path, value;
  std::string origin;  ///< what an error sentence begins with: file and line
};

struct Axis {
  enum class Kind {
    list,         ///< `values`
    range,        ///< `count` points from a to b, both included, in equal steps
    log_range,    ///< the same in equal ratios
    uniform,      ///< drawn between a and b
    log_uniform,  ///< its logarithm is
    normal,       ///< drawn with mean a and standard deviation b, between least and greatest
    integers,     ///< drawn whole numbers from a to b, both included
    seeds         ///< drawn whole numbers from 0 to 2^63 - 1
  };
  std::string path;    ///< of the setting
  std::string origin;  ///< file and line
  Kind kind = Kind::list;
  std::vector<std::string> values;
  double a = 0, b = 0;
  double least, greatest;  ///< of normal; may be infinite
  uint64_t count = 0;      ///< number of its values; 0: random, without a fixed number

  bool is_drawn() const { return kind >= Kind::uniform; }
  /// Value number `index`, below `count`. Random values depend only on the seed, the setting's name
  /// and the index: other axes and a greater count do not change them.
  std::string value(uint64_t index, uint64_t seed) const;
  /// The value below which the share `quantile` of all values lies, 0 <= quantile < 1.
  std::string at_quantile(double quantile, uint64_t seed, uint64_t index) const;
};

/// Random number `index` of the setting `name`, 0 <= number < 1.
double draw(uint64_t seed, const std::string& name, uint64_t index);
uint64_t draw_word(uint64_t seed, const std::string& name, uint64_t index);
/// A seed for a setting: what an integer of TOML holds.
std::string draw_seed(uint64_t seed, const std::string& name, uint64_t index);

/// 0 .. count - 1 in a drawn order.
std::vector<uint32_t> draw_order(uint64_t seed, const std::string& name, uint32_t count);

}  // namespace capsoc::campaign
