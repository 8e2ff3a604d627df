// A result as a list of values, each with a name by which another result has it, too.
#pragma once

#include <string>
#include <vector>

#include "report/result_file.h"

namespace capsoc::report {

/// A number, a text or true or false; a list of these is one value.
struct Value {
  std::vector<std::string> keys;  ///< an element of a list goes by what it is called, or its place
  const Json* json;               ///< in the result, which must outlive this
  std::string unit;               ///< "": none, or none that is known

  /// The first keys with dots between them.
  std::string name(std::size_t depth) const;
  std::string name() const { return name(keys.size()); }
};

/// All values in the order of the result, each name once. Left out are times of the host, which
/// differ from run to run, and the points of curves.
std::vector<Value> values_of(const Json& result);

/// Whether the keys begin with those of the pattern, which has dots between them; "*" is any key.
bool matches(const std::vector<std::string>& keys, const char* pattern);

}  // namespace capsoc::report
