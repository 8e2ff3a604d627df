// Descriptors that one process of the host gives to another over a Unix socket.
#pragma once

#include "host/descriptor.h"

namespace capsoc::host {

/// Sends a copy with one byte. Does not wait. False: the socket took none (errno).
bool send_descriptor(int socket, int descriptor);

/// Waits for one. An invalid one: none came, or a signal was noted (end_signals.h).
Descriptor receive_descriptor(int socket);

}  // namespace capsoc::host
