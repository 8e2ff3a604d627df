#include "serial/pty_backend.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <thread>
#include <utility>

namespace capsoc::serial {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr auto look_again = 5ms;
constexpr auto longest_silence = 5s;  // a client that reads nothing at the end

Error failed(const std::string& what) {
  return Error{fmt::format("pty: {} ({}); choose tcp instead", what, std::strerror(errno))};
}

bool make_raw(int terminal) {
  termios settings{};
  if (tcgetattr(terminal, &settings) != 0) return false;
  cfmakeraw(&settings);
  return tcsetattr(terminal, TCSANOW, &settings) == 0;
}

/// Whether a link may be replaced: left behind by a run that was killed.
bool points_to_terminal(const fs::path& link) {
  std::error_code ignored;
  return fs::is_symlink(fs::symlink_status(link, ignored)) &&
         fs::read_symlink(link, ignored).parent_path() == "/dev/pts";
}

std::optional<Error> make_link(const std::string& terminal, const std::string& link) {
  std::error_code error;
  if (points_to_terminal(link)) fs::remove(link, error);
  fs::create_symlink(terminal, link, error);
  if (!error) return std::nullopt;
  return Error{
      fmt::format("{}: cannot be made a link ({}); name another one", link, error.message())};
}

}  // namespace

Result<std::unique_ptr<CharacterBackend>> PtyBackend::open(const std::string& link,
                                                           GiveUp give_up) {
  host::Descriptor master(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK));
  if (!master.valid() || grantpt(master.get()) != 0 || unlockpt(master.get()) != 0)
    return failed("there is no pseudo-terminal");
  std::array<char, 128> name{};
  if (ptsname_r(master.get(), name.data(), name.size()) != 0) return failed("it has no name");
  // Once it was opened and closed, the terminal reports a hang-up while it has no client.
  const host::Descriptor terminal(::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  if (!terminal.valid() || !make_raw(terminal.get())) return failed("it cannot be opened");
  if (!link.empty())
    if (auto error = make_link(name.data(), link)) return *error;
  std::unique_ptr<PtyBackend> backend(
      new PtyBackend(std::move(master), name.data(), std::move(give_up)));
  backend->link_ = link;
  return std::unique_ptr<CharacterBackend>(std::move(backend));
}

PtyBackend::PtyBackend(host::Descriptor master, std::string terminal, GiveUp give_up)
    : StreamBackend(std::move(give_up)),
      master_(std::move(master)),
      terminal_(std::move(terminal)) {}

PtyBackend::~PtyBackend() {
  std::error_code ignored;
  if (!link_.empty() && fs::read_symlink(link_, ignored) == terminal_) fs::remove(link_, ignored);
}

int PtyBackend::client() {
  pollfd polled{master_.get(), 0, 0};
  const bool hung_up = poll(&polled, 1, 0) > 0 && (polled.revents & POLLHUP) != 0;
  return hung_up ? -1 : master_.get();
}

ssize_t PtyBackend::put(int descriptor, std::string_view bytes) {
  return ::write(descriptor, bytes.data(), bytes.size());
}

ssize_t PtyBackend::get(int descriptor, std::string& bytes) {
  return ::read(descriptor, bytes.data(), bytes.size());
}

/// Bytes that wait for the client's read.
int PtyBackend::unread() const {
  const host::Descriptor terminal(
      ::open(terminal_.c_str(), O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  int count = 0;
  return terminal.valid() && ioctl(terminal.get(), FIONREAD, &count) == 0 ? count : 0;
}

/// Closing the master takes away what the client has not read yet, so that comes first. Bytes on
/// their way into the terminal are not counted, hence the second look.
void PtyBackend::finish() {
  int before = -1, empty = 0;
  auto moved_at = std::chrono::steady_clock::now();
  while (empty < 3 && client() >= 0 && !gives_up()) {
    const int now = unread();
    empty = now == 0 ? empty + 1 : 0;
    if (now != std::exchange(before, now)) moved_at = std::chrono::steady_clock::now();
    if (std::chrono::steady_clock::now() - moved_at > longest_silence) return;
    std::this_thread::sleep_for(look_again);
  }
}

}  // namespace capsoc::serial
