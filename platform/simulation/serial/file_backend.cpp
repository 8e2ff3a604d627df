#include "serial/file_backend.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <limits.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include "host/end_signals.h"
#include "host/files.h"

namespace capsoc::serial {
namespace {

bool readable(int descriptor) {
  pollfd polled{descriptor, POLLIN, 0};
  return poll(&polled, 1, 0) > 0;
}

/// A process in the background that reads its terminal is stopped.
bool in_foreground() {
  return tcgetpgrp(STDIN_FILENO) == getpgrp();
}

}  // namespace

FileBackend::FileBackend(int output, host::Descriptor owned, std::string name, Input input,
                         GiveUp give_up)
    : output_(output),
      owned_(std::move(owned)),
      name_(std::move(name)),
      input_(input),
      give_up_(std::move(give_up)) {}

Result<std::unique_ptr<CharacterBackend>> FileBackend::to_file(const std::string& path,
                                                               const GiveUp& give_up) {
  struct stat status {};
  const bool exists = stat(path.c_str(), &status) == 0;
  if (!exists)
    if (auto error = host::check_writable(path)) return *error;
  host::Descriptor file(exists ? host::open_to_write(path, 0) : -1);
  if (exists && !file.valid()) return host::cannot_write(path, errno);
  const int number = file.get();
  std::unique_ptr<FileBackend> backend(
      new FileBackend(number, std::move(file), path, Input::none, give_up));
  backend->untouched_ = !exists || S_ISREG(status.st_mode);
  return std::unique_ptr<CharacterBackend>(std::move(backend));
}

/// The file is as it was until the run has begun: another option may still be refused.
void FileBackend::begin() {
  untouched_ = false;
  if (!owned_.valid()) {
    owned_.reset(open(name_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOCTTY, 0666));
    output_ = owned_.get();
  }
  if (!owned_.valid() || ftruncate(owned_.get(), 0) != 0)
    failure_ = fmt::format("{}: takes no bytes ({})", name_, std::strerror(errno));
}

std::unique_ptr<CharacterBackend> FileBackend::standard(bool reads, const GiveUp& give_up) {
  Input input = Input::none;
  struct stat status {};
  if (reads && fstat(STDIN_FILENO, &status) == 0)
    input = S_ISREG(status.st_mode)     ? Input::file
            : isatty(STDIN_FILENO) != 0 ? Input::terminal
                                        : Input::pipe;
  return std::unique_ptr<CharacterBackend>(
      new FileBackend(STDOUT_FILENO, host::Descriptor(), "stdout", input, give_up));
}

std::unique_ptr<CharacterBackend> FileBackend::standard_error(const GiveUp& give_up) {
  return std::unique_ptr<CharacterBackend>(
      new FileBackend(STDERR_FILENO, host::Descriptor(), "stderr", Input::none, give_up));
}

std::unique_ptr<CharacterBackend> FileBackend::null() {
  return std::unique_ptr<CharacterBackend>(
      new FileBackend(-1, host::Descriptor(), "", Input::none, {}));
}

bool FileBackend::wait_writable() {
  pollfd polled{output_, POLLOUT, 0};
  while (poll(&polled, 1, patience_ms) <= 0)
    if (give_up_()) return false;
  return true;
}

void FileBackend::write(std::string_view bytes) {
  if (untouched_) begin();
  if (output_ < 0 || !failure_.empty()) return;
  while (!bytes.empty()) {
    if (!wait_writable()) return;
    // A pipe that is writable takes so much without blocking.
    const ssize_t done =
        ::write(output_, bytes.data(), std::min<std::size_t>(bytes.size(), PIPE_BUF));
    if (done > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(done));
    } else if (done < 0 && errno != EINTR && errno != EAGAIN) {
      const int error = errno;
      failure_ = fmt::format("{}: takes no more bytes ({})", name_, std::strerror(error));
      // Any program in a pipe ends when the reader of its standard output is gone.
      if (error == EPIPE && output_ == STDOUT_FILENO) host::note_signal(SIGPIPE);
      return;
    }
  }
}

/// Some file systems tell of a full disk only here.
void FileBackend::finish() {
  if (untouched_) begin();
  if (!owned_.valid()) return;
  output_ = -1;
  if (close(owned_.release()) != 0 && failure_.empty())
    failure_ = fmt::format("{}: did not take all bytes ({})", name_, std::strerror(errno));
}

std::string FileBackend::read() {
  if (input_ == Input::none) return {};
  if (live() && !readable(STDIN_FILENO)) return {};
  if (input_ == Input::terminal && !in_foreground()) return {};
  std::string bytes(piece, '\0');
  const ssize_t got = ::read(STDIN_FILENO, bytes.data(), bytes.size());
  if (got == 0 || (got < 0 && errno != EINTR && errno != EAGAIN)) input_ = Input::none;
  bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  return bytes;
}

}  // namespace capsoc::serial
