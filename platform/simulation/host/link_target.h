// Where a name on the command line leads to.
#pragma once

#include <string>

namespace capsoc::host {

/// The end of a chain of symbolic links.
struct Place {
  std::string path;     ///< no link, if it exists; it need not exist
  int descriptor = -1;  ///< the name is that of an open descriptor of this program (/dev/stdout, -)
  bool special = false;  ///< a device, a pipe, a socket, or any process's descriptor

  /// Written where it is; everything else is replaced.
  bool in_place() const { return special || descriptor >= 0; }
};

Place place_of(const std::string& path);

}  // namespace capsoc::host
