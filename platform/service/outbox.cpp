#include "service/outbox.h"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace capsoc::service {

void Outbox::add(std::string bytes) {
  if (empty()) {
    bytes_ = std::move(bytes);
    taken_ = 0;
    return;
  }
  bytes_ += bytes;
}

bool Outbox::write_to(int descriptor) {
  while (!empty()) {
    const ssize_t count = write(descriptor, bytes_.data() + taken_, bytes_.size() - taken_);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno == EAGAIN || errno == EWOULDBLOCK;
    taken_ += static_cast<std::size_t>(count);
  }
  bytes_.clear();
  taken_ = 0;
  return true;
}

}  // namespace capsoc::service
