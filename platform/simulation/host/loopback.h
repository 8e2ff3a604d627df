// TCP on this machine alone.
#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"
#include "host/descriptor.h"

namespace capsoc::host {

/// A socket that listens on 127.0.0.1.
struct Listener {
  Descriptor socket;
  uint16_t port = 0;  ///< as bound
};

/// Port 0 takes a free one. `option` begins the sentence of an error ("--gdb").
Result<Listener> listen_on_loopback(uint16_t port, const std::string& option);

}  // namespace capsoc::host
