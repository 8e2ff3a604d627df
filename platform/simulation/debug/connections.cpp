#include "debug/connections.h"

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

#include "host/loopback.h"

namespace capsoc::debug {
namespace {

constexpr time_t longest_send_s = 5;
constexpr std::size_t most_connections = 16;

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
  auto listener = host::listen_on_loopback(port, "--gdb");
  if (!listener) return Error{listener.error()};
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0)
    return Error{fmt::format("--gdb {}: no pipe can be opened ({})", port, std::strerror(errno))};
  return std::unique_ptr<Connections>(
      new Connections(std::make_shared<Socket>(listener.value().socket.release()),
                      listener.value().port, ends[0], ends[1]));
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
