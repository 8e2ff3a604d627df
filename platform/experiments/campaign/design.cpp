#include "campaign/design.h"

#include <algorithm>
#include <utility>

namespace capsoc::campaign {

Design::Design(const Description& description) : description_(description) {
  for (const AxisGroup& group : description.groups) {
    auto& orders = orders_.emplace_back();
    if (group.combine != AxisGroup::Combine::latin_hypercube) continue;
    for (const Axis& axis : group.axes)
      orders.push_back(draw_order(description.seed, axis.path, static_cast<uint32_t>(group.runs)));
  }
}

std::vector<std::string> Design::values(uint64_t run) const {
  const uint64_t seed = description_.seed;
  const uint64_t repetition = run % description_.repetitions;
  uint64_t rest = run / description_.repetitions;
  std::vector<std::vector<std::string>> parts(description_.groups.size());
  for (std::size_t g = description_.groups.size(); g-- > 0;) {
    const AxisGroup& group = description_.groups[g];
    uint64_t index = rest % group.runs;
    rest /= group.runs;
    std::vector<std::string>& part = parts[g];
    part.resize(group.axes.size());
    for (std::size_t a = group.axes.size(); a-- > 0;) {
      const Axis& axis = group.axes[a];
      switch (group.combine) {
        case AxisGroup::Combine::product:
          part[a] = axis.value(index % axis.count, seed);
          index /= axis.count;
          break;
        case AxisGroup::Combine::zip:
          part[a] = axis.value(index, seed);
          break;
        case AxisGroup::Combine::independent:
          part[a] = axis.at_quantile(draw(seed, axis.path, index), seed, index);
          break;
        case AxisGroup::Combine::latin_hypercube: {
          const double share = (orders_[g][a][index] + draw(seed, axis.path, index)) /
                               static_cast<double>(group.runs);
          // The sum of the two can round up to the whole.
          part[a] = axis.at_quantile(std::min(share, 1 - 0x1p-53), seed, index);
        }
      }
    }
  }
  std::vector<std::string> values;
  for (std::vector<std::string>& part : parts)
    for (std::string& value : part) values.push_back(std::move(value));
  for (const Assignment& seeds : description_.repetition_seeds)
    values.push_back(draw_seed(seed, seeds.path, repetition));
  return values;
}

}  // namespace capsoc::campaign
