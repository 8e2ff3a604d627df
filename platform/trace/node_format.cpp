#include "trace/node_format.h"

#include <algorithm>
#include <cmath>

namespace capsoc::trace {
namespace {

constexpr NodeFormat flag{1, false, 0, Meaning::word}, upper{4, true, 0, Meaning::word},
    lower{64, false, 0, Meaning::word}, word{32, false, 0, Meaning::word},
    q1_31{32, true, 31, Meaning::number}, average{32, false, 31, Meaning::number},
    q2_46{48, true, 46, Meaning::number}, angle{32, false, 32, Meaning::turns},
    residue{32, true, 32, Meaning::turns}, phase{48, false, 48, Meaning::turns},
    frequency{48, true, 48, Meaning::turns}, travel{32, true, 30, Meaning::turns},
    deviation{32, false, 31, Meaning::number}, count{5, false, 0, Meaning::word};

struct Named {
  std::string_view name;
  NodeFormat format;
};

// In the order of the pipeline.
constexpr Named formats[] = {
    {"u", q1_31},
    {"v", q1_31},
    {"clip", flag},
    {"s_high", upper},
    {"s_low", lower},
    {"c_high", upper},
    {"c_low", lower},
    {"mirror", flag},
    {"cal_s", q1_31},
    {"cal_c", q1_31},
    {"det", q1_31},
    {"saturated_t0", flag},
    {"relative", angle},
    {"amplitude", q1_31},
    {"zero", flag},
    {"unsettled_t1", flag},
    {"saturated_t1", flag},
    {"reference_phase", angle},
    {"residue", residue},
    {"sine", q1_31},
    {"cosine", q1_31},
    {"next_phase", phase},
    {"next_frequency", frequency},
    {"turn", flag},
    {"saturated_t2", flag},
    {"error_u", q1_31},
    {"error_v", q1_31},
    {"next_a_u", q2_46},
    {"next_b_u", q2_46},
    {"next_c_u", q2_46},
    {"next_a_v", q2_46},
    {"next_b_v", q2_46},
    {"next_c_v", q2_46},
    {"next_average", average},
    {"saturated_t3", flag},
    {"found_phi", angle},
    {"found_a1", q1_31},
    {"found_beta", angle},
    {"found_a2", q1_31},
    {"found_b1", q1_31},
    {"found_b2", q1_31},
    {"found_angle", angle},
    {"saturated", flag},
    {"deviation", deviation},
    {"travel", travel},
    {"glitches", count},
    {"phase", phase},
    {"frequency", frequency},
    {"a_u", q2_46},
    {"b_u", q2_46},
    {"c_u", q2_46},
    {"a_v", q2_46},
    {"b_v", q2_46},
    {"c_v", q2_46},
    {"a1", q1_31},
    {"a2", q1_31},
    {"b1", q1_31},
    {"b2", q1_31},
    {"beta", angle},
    {"phi", angle},
    {"angle", angle},
    {"error_average", average},
    {"status", word},
    {"flags", word},
    {"samples", word},
    {"turn_flags", word},
};

}  // namespace

double NodeFormat::value(int64_t raw) const {
  const double scaled = std::ldexp(static_cast<double>(raw), -static_cast<int>(fraction));
  return meaning == Meaning::turns ? scaled * 360 : scaled;
}

NodeFormat node_format(std::string_view name) {
  const auto* found = std::find_if(std::begin(formats), std::end(formats),
                                   [name](const Named& named) { return named.name == name; });
  return found == std::end(formats) ? lower : found->format;
}

}  // namespace capsoc::trace
