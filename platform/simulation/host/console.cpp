#include "host/console.h"

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <iostream>

#include "host/end_signals.h"

namespace capsoc::host {
namespace {

/// errno of the first failure of standard output; 0: none that print() has seen.
std::atomic<int> output_error{0};

/// A reader that has gone raises no SIGPIPE in this scope.
class WithoutBrokenPipe {
 public:
  WithoutBrokenPipe() {
    sigemptyset(&pipe_);
    sigaddset(&pipe_, SIGPIPE);
    sigset_t pending;
    sigpending(&pending);
    was_pending_ = sigismember(&pending, SIGPIPE) == 1;
    pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~WithoutBrokenPipe() {
    constexpr timespec at_once{0, 0};
    if (!was_pending_)
      while (sigtimedwait(&pipe_, nullptr, &at_once) == -1 && errno == EINTR) {
      }
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  WithoutBrokenPipe(const WithoutBrokenPipe&) = delete;
  WithoutBrokenPipe& operator=(const WithoutBrokenPipe&) = delete;

 private:
  sigset_t pipe_{}, before_{};
  bool was_pending_ = false;
};

}  // namespace

void reserve_standard_streams() {
  for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(number, F_GETFD) != -1 || errno != EBADF) continue;
    // The lowest free number is this one. Its wrong direction makes every use fail.
    const int got = open("/dev/null", number == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    if (got >= 0 && got != number) close(got);
  }
}

namespace {

constexpr int patience_ms = 10;
/// For all output after a signal or a limit, to a pipe that is full.
constexpr int longest_farewell_ms = 200;

/// False: the pipe's reader does not read, and the program is to end.
bool wait_for_standard_error() {
  static std::atomic<int> waited_ms{0};
  pollfd polled{STDERR_FILENO, POLLOUT, 0};
  while (poll(&polled, 1, patience_ms) <= 0)
    if (is_ending() && (waited_ms += patience_ms) > longest_farewell_ms) return false;
  return true;
}

}  // namespace

void say(std::string_view text) {
  const WithoutBrokenPipe quiet;
  while (!text.empty() && wait_for_standard_error()) {
    // A pipe that is writable takes so much without blocking.
    const ssize_t done =
        write(STDERR_FILENO, text.data(), std::min<std::size_t>(text.size(), PIPE_BUF));
    if (done > 0) {
      text.remove_prefix(static_cast<std::size_t>(done));
    } else if (done == 0 || (errno != EINTR && errno != EAGAIN)) {
      return;
    }
  }
}

void print(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size()) return;
  int none = 0;
  output_error.compare_exchange_strong(none, errno);
}

std::optional<Error> finish_output() {
  std::cout.flush();
  if (std::fflush(stdout) != 0) {
    int none = 0;
    output_error.compare_exchange_strong(none, errno);
  }
  if (output_error == 0 && std::ferror(stdout) == 0 && std::cout.good()) return std::nullopt;
  const char* reason = output_error == 0 ? "perhaps its disk is full" : std::strerror(output_error);
  return Error{
      fmt::format("standard output: could not take everything ({}); send it elsewhere", reason)};
}

}  // namespace capsoc::host
