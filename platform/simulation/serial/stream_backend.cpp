#include "serial/stream_backend.h"

#include <poll.h>

#include <cerrno>
#include <utility>

namespace capsoc::serial {
namespace {

// A client may send this much before it reads its first answer. Then both sides wait for each
// other, which is the client's doing.
constexpr std::size_t most_ahead = std::size_t{64} << 20U;

bool try_again(int error) {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

}  // namespace

void StreamBackend::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const int descriptor = client();
    if (descriptor < 0) return;
    const ssize_t done = put(descriptor, bytes);
    if (done > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(done));
    } else if (done < 0 && !try_again(errno)) {
      return lost();
    } else {
      if (gives_up()) return;
      wait_for_room(descriptor);
    }
  }
}

/// Takes in what the client sends meanwhile, so that one that writes first and reads later gets on.
void StreamBackend::wait_for_room(int descriptor) {
  const short wanted = ahead_.size() < most_ahead ? POLLIN | POLLOUT : POLLOUT;
  pollfd polled{descriptor, wanted, 0};
  if (poll(&polled, 1, patience_ms) > 0 && (polled.revents & wanted & POLLIN) != 0)
    ahead_ += receive(descriptor);
}

std::string StreamBackend::receive(int descriptor) {
  std::string bytes(piece, '\0');
  const ssize_t got = get(descriptor, bytes);
  if (got == 0) input_ended();
  if (got < 0 && !try_again(errno)) lost();
  bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  return bytes;
}

std::string StreamBackend::read() {
  if (!ahead_.empty()) return std::exchange(ahead_, {});
  const int descriptor = source();
  return descriptor < 0 ? std::string() : receive(descriptor);
}

}  // namespace capsoc::serial
