#include "serial/tcp_backend.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <utility>

namespace capsoc::serial {
namespace {

constexpr int longest_farewell_ms = 1000;

}  // namespace

Result<std::unique_ptr<CharacterBackend>> TcpBackend::open(uint16_t port, const std::string& option,
                                                           GiveUp give_up) {
  auto listener = host::listen_on_loopback(port, option);
  if (!listener) return Error{listener.error()};
  const int socket = listener.value().socket.get();
  fcntl(socket, F_SETFL, fcntl(socket, F_GETFL) | O_NONBLOCK);
  return std::unique_ptr<CharacterBackend>(
      new TcpBackend(std::move(listener.value()), std::move(give_up)));
}

TcpBackend::TcpBackend(host::Listener listener, GiveUp give_up)
    : StreamBackend(std::move(give_up)), listener_(std::move(listener)) {}

std::string TcpBackend::place() const {
  return fmt::format("listening on 127.0.0.1:{}", listener_.port);
}

int TcpBackend::client() {
  if (client_.valid() && !half_closed_) return client_.get();
  const int next = accept4(listener_.socket.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (next < 0) return client_.get();
  client_.reset(next);
  half_closed_ = false;
  const int on = 1;
  setsockopt(next, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return next;
}

ssize_t TcpBackend::put(int descriptor, std::string_view bytes) {
  return send(descriptor, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

ssize_t TcpBackend::get(int descriptor, std::string& bytes) {
  if (half_closed_) {
    errno = EAGAIN;
    return -1;
  }
  return recv(descriptor, bytes.data(), bytes.size(), MSG_DONTWAIT);
}

/// A socket that is closed with unread bytes in it resets the connection, and the peer may lose
/// what is under way. So the peer closes first, or gets a second of the host's time for it.
void TcpBackend::finish() {
  if (!client_.valid()) return;
  shutdown(client_.get(), SHUT_WR);
  std::string bytes(65536, '\0');
  for (int waited = 0; !half_closed_ && waited < longest_farewell_ms && !gives_up();) {
    pollfd polled{client_.get(), POLLIN, 0};
    if (poll(&polled, 1, patience_ms) <= 0) {
      waited += patience_ms;
      continue;
    }
    if (recv(client_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT) <= 0) break;
  }
  client_.reset();
}

}  // namespace capsoc::serial
