#include "service/doors.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "base/printable.h"
#include "host/console.h"
#include "host/loopback.h"

namespace capsoc::service {

Result<Door> open_socket(const std::string& path) {
  const auto failed = [&](const char* why) {
    return Error{fmt::format("--socket {}: cannot listen ({}); name another path",
                             printable(path, 200), why)};
  };
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path)
    return failed("the path is empty, or longer than 107 bytes");
  path.copy(address.sun_path, path.size());
  Door door;
  door.listener.reset(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!door.listener.valid()) return failed(std::strerror(errno));
  const mode_t mask = umask(0177);
  const int bound =
      bind(door.listener.get(), reinterpret_cast<sockaddr*>(&address), sizeof address);
  const int error = errno;
  umask(mask);
  if (bound != 0) return failed(std::strerror(error));
  if (listen(door.listener.get(), 4) != 0) return failed(std::strerror(errno));
  door.checks_user = true;
  return door;
}

Result<Door> open_port(uint16_t port) {
  auto listener = host::listen_on_loopback(port, "--port");
  if (!listener) return Error{listener.error()};
  Door door;
  door.listener = std::move(listener.value().socket);
  fcntl(door.listener.get(), F_SETFL, O_NONBLOCK);
  std::array<uint8_t, 16> random{};
  if (getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size()))
    return Error{"--port: the system has no random numbers for a token; use --socket"};
  for (const uint8_t byte : random) door.token += fmt::format("{:02x}", byte);
  host::say("session: listening on 127.0.0.1:{}, token {}\n", listener.value().port, door.token);
  return door;
}

}  // namespace capsoc::service
