// A run's state as a file. docs/guide/checkpoints.md describes the format.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "base/archive.h"
#include "base/result.h"

namespace capsoc::checkpoint {

/// The format's version; another one is refused.
inline constexpr int version = 1;

/// A part of a run that has a state.
struct Part {
  std::string name;  ///< unique
  std::function<void(Archive&)> visit;
};

/// What a run was, as far as a run that continues must be the same: names and values.
using Identity = std::vector<std::pair<std::string, std::string>>;

/// The state of one part: a StateWriter's bytes and the hash of its layout.
struct Section {
  std::string name, bytes;
  uint64_t layout = 0;
};

struct Checkpoint {
  uint64_t time = 0;       ///< simulated, in units of the kernel's resolution (1 ps)
  std::string written_by;  ///< for people: version and commit of the program
  Identity identity;
  std::vector<Section> sections;
};

/// The state of all parts. An Error: one of them cannot be saved.
Result<Checkpoint> save(uint64_t time, const std::vector<Part>& parts);

/// Gives all parts their state back. An Error names the part and what is wrong; some parts may have
/// the new state by then.
std::optional<Error> load(const Checkpoint& checkpoint, const std::vector<Part>& parts);

/// The bytes of a file and back. `file` begins the sentence of an error: no checkpoint, another
/// version, damaged (with the part), cut off, or followed by something else.
std::string pack(const Checkpoint& checkpoint);
Result<Checkpoint> unpack(const std::string& bytes, const std::string& file);

/// Reads a file and unpacks it.
Result<Checkpoint> read(const std::string& file);

}  // namespace capsoc::checkpoint
