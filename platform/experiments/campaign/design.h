// The values of the axes in each run.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "campaign/description.h"

namespace capsoc::campaign {

/// Of a description, which must outlive it.
class Design {
 public:
  explicit Design(const Description& description);
  /// Of run 0 .. runs() - 1, in the order of axis_paths().
  std::vector<std::string> values(uint64_t run) const;

 private:
  const Description& description_;
  std::vector<std::vector<std::vector<uint32_t>>> orders_;  // of each group's axes, for hypercubes
};

}  // namespace capsoc::campaign
