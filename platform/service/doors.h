#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"
#include "service/session.h"

namespace capsoc::service {

/// A Unix socket at a path where nothing is yet, mode 0600, for processes of the same user. The
/// process that opened it removes it. An Error says why there is none.
Result<Door> open_socket(const std::string& path);

/// A port of 127.0.0.1, 0: a free one, and a token of 128 random bits. Says on standard error where
/// it is.
Result<Door> open_port(uint16_t port);

}  // namespace capsoc::service
