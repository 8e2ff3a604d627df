#include "host/loopback.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

namespace capsoc::host {

Result<Listener> listen_on_loopback(uint16_t port, const std::string& option) {
  const auto failed = [&] {
    return Error{fmt::format("{} {}: cannot listen ({}); choose another port, 0 for a free one",
                             option, port, std::strerror(errno))};
  };
  Descriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (!socket.valid()) return failed();
  const int on = 1;
  setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  if (bind(socket.get(), reinterpret_cast<sockaddr*>(&address), size) != 0) return failed();
  if (::listen(socket.get(), 4) != 0) return failed();
  if (getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0) return failed();
  return Listener{std::move(socket), ntohs(address.sin_port)};
}

}  // namespace capsoc::host
