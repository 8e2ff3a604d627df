// The keys of a description by name, for callers that set one from outside its file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sensor/source.h"

namespace capsoc::sensor {

/// A key that is set from outside: name as DescriptionKey has it, or a harmonic's
/// ("harmonics.u3_amplitude", "harmonics.v12_phase_rad": channel, order, key). An empty value
/// removes the key.
struct KeyValue {
  std::string name, value;
  std::string origin;  ///< what the error sentence begins with
};

/// One key. Keys of [signal] and [sampling] and those outside a table have their own name, others
/// that of their table before it: "a1", "motion.frequency_hz".
struct DescriptionKey {
  enum class Kind { number, integer, text, list };
  const char* table;  ///< "" outside a table
  const char* key;
  Kind kind;
  const char* help;

  std::string name() const;
};

/// All but those of harmonics. The converter's width is none of them: run settings have it.
const std::vector<DescriptionKey>& description_keys();

/// What begins the names of harmonics' keys.
constexpr const char* harmonics_prefix = "harmonics.";

/// The keys of [motion] for a kind, "kind" first; those without which there is no such motion.
std::vector<std::string> motion_keys(MotionKind kind);

/// The kind of a word in a description, nothing for an unknown one.
std::optional<MotionKind> motion_kind(const std::string& word);

}  // namespace capsoc::sensor
