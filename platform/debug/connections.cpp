#include "debug/connections.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>
#include <vector>

namespace capsoc::debug {
namespace {

constexpr time_t longest_send_s = 5;
constexpr std::size_t most_connections = 16;

sockaddr_in loopback(uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

void prepare(int descriptor) {
  const int on = 1;
  setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  const timeval longest{longest_send_s, 0};
  setsockopt(descriptor, SOL_SOCKET, SO_SNDTIMEO, &longest, sizeof longest);
}

}  // namespace

Socket::~Socket() {
  close(descriptor_);
}

bool Socket::send(std::string_view bytes) const {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

void Socket::shut_down() const {
  shutdown(descriptor_, SHUT_RDWR);
}

Result<std::unique_ptr<Connections>> Connections::listen(uint16_t port) {
  const auto failed = [port] {
    return Error{fmt::format("--gdb {}: cannot listen ({}); choose another port, 0 for a free one",
                             port, std::strerror(errno))};
  };
  const int descriptor = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return failed();
  auto listener = std::make_shared<Socket>(descriptor);
  const int on = 1;
  setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in address = loopback(port);
  socklen_t size = sizeof address;
  if (bind(descriptor, reinterpret_cast<sockaddr*>(&address), size) != 0) return failed();
  if (::listen(descriptor, 4) != 0) return failed();
  if (getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size) != 0) return failed();
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) return failed();
  return std::unique_ptr<Connections>(
      new Connections(std::move(listener), ntohs(address.sin_port), ends[0], ends[1]));
}

Connections::Connections(std::shared_ptr<Socket> listener, uint16_t port, int stop_read,
                         int stop_write)
    : listener_(std::move(listener)),
      stop_read_(std::make_shared<Socket>(stop_read)),
      stop_write_(std::make_shared<Socket>(stop_write)),
      port_(port) {
  // Signals are the main thread's.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread([this] { receive(); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

Connections::~Connections() {
  const char stop = 0;
  if (write(stop_write_->get(), &stop, 1) == 1) thread_.join();
}

void Connections::post(LineEvent event) {
  const std::lock_guard<std::mutex> lock(mutex_);
  events_.push_back(std::move(event));
  any_ = true;
  arrived_.notify_all();
}

bool Connections::next(LineEvent& event) {
  const std::lock_guard<std::mutex> lock(mutex_);
  any_ = events_.size() > 1;
  if (events_.empty()) return false;
  event = std::move(events_.front());
  events_.pop_front();
  return true;
}

void Connections::wait(std::chrono::milliseconds longest) {
  std::unique_lock<std::mutex> lock(mutex_);
  arrived_.wait_for(lock, longest, [this] { return !events_.empty(); });
}

void Connections::receive() {
  std::vector<std::shared_ptr<Socket>> open;
  std::string buffer(65536, '\0');
  for (;;) {
    std::vector<pollfd> polled{{stop_read_->get(), POLLIN, 0}, {listener_->get(), POLLIN, 0}};
    for (const auto& socket : open) polled.push_back({socket->get(), POLLIN, 0});
    if (poll(polled.data(), polled.size(), -1) < 0) continue;
    if (polled[0].revents != 0) return;
    for (std::size_t i = open.size(); i-- > 0;) {
      if (polled[i + 2].revents == 0) continue;
      const ssize_t got = recv(open[i]->get(), buffer.data(), buffer.size(), 0);
      if (got > 0) {
        post({open[i], LineEvent::Kind::received, buffer.substr(0, static_cast<std::size_t>(got))});
      } else if (got == 0 || errno != EINTR) {
        post({open[i], LineEvent::Kind::closed});
        open.erase(open.begin() + static_cast<std::ptrdiff_t>(i));
      }
    }
    if (polled[1].revents == 0) continue;
    const int descriptor = accept4(listener_->get(), nullptr, nullptr, SOCK_CLOEXEC);
    if (descriptor < 0) continue;
    auto socket = std::make_shared<Socket>(descriptor);
    if (open.size() >= most_connections) continue;
    prepare(descriptor);
    open.push_back(socket);
    post({socket, LineEvent::Kind::connected});
  }
}

}  // namespace capsoc::debug
