// A file that a run read, as its results name it.
#pragma once

#include <string>

namespace capsoc::run {

struct Input {
  std::string role, path, sha256;
};

}  // namespace capsoc::run
