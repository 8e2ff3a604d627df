#include "coprocessor/nodes.h"

#include <cmath>

#include "base/archive.h"

namespace capsoc::coprocessor {
namespace formats {

#define FORMAT(name, width, is_signed, fraction, meaning) \
  constexpr NodeFormat name{width, is_signed, fraction, Meaning::meaning};
#include "coprocessor/nodes.def"

}  // namespace formats

const std::array<NamedNode, node_count>& node_names() {
  static constexpr std::array<NamedNode, node_count> names = {{
#define NODE(name, stage, unit, format, model, when, rtl) \
  {#name, stage, Unit::unit, &Nodes::name, formats::format},
#include "coprocessor/nodes.def"
  }};
  return names;
}

const char* name_of(Unit unit) {
  switch (unit) {
    case Unit::calibrator:
      return "calibrator";
    case Unit::polar_unit:
      return "polar unit";
    case Unit::reference_generator:
      return "reference generator";
    case Unit::lms_demodulator:
      return "LMS demodulator";
    case Unit::turn_judge:
      return "turn judge";
    case Unit::register_bank:
      return "register bank";
  }
  return "";
}

void Nodes::visit(Archive& archive) {
  for (const NamedNode& node : node_names()) archive(node.name, this->*node.value);
  archive("commits", commits);
  archive("taken", taken);
}

double NodeFormat::value(int64_t word) const {
  const double scaled = std::ldexp(static_cast<double>(word), -static_cast<int>(fraction));
  return meaning == Meaning::turns ? scaled * 360 : scaled;
}

bool NodeFormat::fits(int64_t word) const {
  if (width >= 64) return true;
  const auto high = static_cast<uint64_t>(word) << (64 - width);
  const int64_t extended = is_signed ? static_cast<int64_t>(high) >> (64 - width)
                                     : static_cast<int64_t>(high >> (64 - width));
  return extended == word;
}

}  // namespace capsoc::coprocessor
