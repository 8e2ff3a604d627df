#pragma once

#include <array>
#include <cstddef>

namespace capsoc::kit {

/// A rule of the TLM-2.0 base protocol (protocol_rules.def).
enum class ProtocolRule {
#define RULE(name, clause, text) name,
#include "kit/protocol_rules.def"
#undef RULE
};

struct ProtocolRuleText {
  ProtocolRule rule;
  const char* name;
  const char* clause;  ///< of IEEE 1666-2011
  const char* text;    ///< what holds, one sentence
};

/// All rules, in the order of ProtocolRule.
constexpr std::array protocol_rules{
#define RULE(name, clause, text) ProtocolRuleText{ProtocolRule::name, #name, clause, text},
#include "kit/protocol_rules.def"
#undef RULE
};

constexpr const ProtocolRuleText& describe(ProtocolRule rule) {
  return protocol_rules[static_cast<std::size_t>(rule)];
}

}  // namespace capsoc::kit
