#include "host/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "host/link_target.h"

namespace capsoc::host {
namespace {

std::optional<Error> write_growing(const TextFile& file) {
  std::FILE* stream = open_growing(file.path);
  if (stream == nullptr) return cannot_write(file.path, errno);
  const bool written =
      std::fwrite(file.text.data(), 1, file.text.size(), stream) == file.text.size();
  const int write_error = errno;
  if (std::fclose(stream) != 0 || !written)
    return cannot_write(file.path, written ? errno : write_error);
  return std::nullopt;
}

/// A device or a descriptor is not opened for a try: a pipe would take that for its end.
std::optional<Error> check_in_place(const std::string& path, const Place& place) {
  if (place.descriptor >= 0) {
    const int flags = fcntl(place.descriptor, F_GETFL);
    if (flags == -1) return cannot_write(path, errno);
    if ((flags & O_ACCMODE) == O_RDONLY) return cannot_write(path, EBADF);
    return std::nullopt;
  }
  if (access(place.path.c_str(), W_OK) != 0) return cannot_write(path, errno);
  return std::nullopt;
}

}  // namespace

Error cannot_write(const std::string& path, int error) {
  if (error == EINTR)
    return Error{path + ": cannot be written: the program was ended while it waited for a reader"};
  return Error{
      fmt::format("{}: cannot be written ({}); name another file", path, std::strerror(error))};
}

Result<std::string> read_standard_input(std::size_t largest) {
  std::string text;
  char buffer[65536];
  for (;;) {
    const ssize_t count = read(STDIN_FILENO, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0)
      return Error{fmt::format("standard input: cannot be read ({}); name a file instead",
                               std::strerror(errno))};
    if (count == 0) return text;
    text.append(buffer, static_cast<std::size_t>(count));
    if (text.size() > largest)
      return Error{fmt::format("standard input: more than {} bytes; shorten it", largest)};
  }
}

int open_to_write(const std::string& path, int flags) {
  constexpr useconds_t nap_us = 10000;
  // A pipe without a reader is refused at once so, with ENXIO.
  const int how = O_WRONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK | flags;
  int file = -1;
  while ((file = open(path.c_str(), how)) < 0 && errno == ENXIO) {
    struct stat status {};
    if (stat(path.c_str(), &status) != 0 || !S_ISFIFO(status.st_mode)) {
      errno = ENXIO;
      return -1;
    }
    if (is_ending()) {
      errno = EINTR;
      return -1;
    }
    usleep(nap_us);
  }
  if (file >= 0) fcntl(file, F_SETFL, fcntl(file, F_GETFL) & ~O_NONBLOCK);
  return file;
}

std::string growing_name(const std::string& path) {
  const Place place = place_of(path);
  return place.in_place() ? path : fmt::format("{}.{}.tmp", place.path, getpid());
}

std::FILE* open_growing(const std::string& path) {
  const Place place = place_of(path);
  if (place.special && place.descriptor < 0) {
    const int file = open_to_write(place.path, 0);
    return file < 0 ? nullptr : fdopen(file, "wb");
  }
  if (place.descriptor < 0) return std::fopen(growing_name(path).c_str(), "wb");
  // Opened again it would begin at the front of a file that others write to as well.
  const int copy = fcntl(place.descriptor, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  if (copy < 0) return nullptr;
  std::fflush(stdout);
  std::FILE* stream = fdopen(copy, "wb");
  if (stream == nullptr) close(copy);
  return stream;
}

GrowingFile::GrowingFile(const std::string& path) : path_(path), growing_(growing_name(path)) {
  if (growing_ != path_) removed_.emplace(growing_);
}

GrowingFile::GrowingFile(GrowingFile&& other) noexcept
    : path_(std::move(other.path_)),
      growing_(std::move(other.growing_)),
      removed_(std::move(other.removed_)) {
  other.removed_.reset();
}

GrowingFile::~GrowingFile() {
  if (removed_) std::remove(growing_.c_str());
}

std::optional<Error> GrowingFile::name() {
  if (!removed_) return std::nullopt;
  if (std::rename(growing_.c_str(), place_of(path_).path.c_str()) != 0)
    return cannot_write(path_, errno);
  removed_.reset();
  return std::nullopt;
}

std::optional<Error> write_together(const std::vector<TextFile>& files) {
  for (const TextFile& file : files)  // a rename onto a directory would fail half-way
    if (auto error = check_writable(file.path)) return error;
  std::vector<GrowingFile> growing;
  growing.reserve(files.size());
  for (const TextFile& file : files) growing.emplace_back(file.path);
  for (const TextFile& file : files)
    if (auto error = write_growing(file)) return error;
  for (GrowingFile& file : growing)
    if (auto error = file.name()) return error;
  return std::nullopt;
}

std::optional<Error> write_whole(const std::string& path, const std::string& text) {
  return write_together({{path, text}});
}

std::optional<Error> check_writable(const std::string& path) {
  const Place place = place_of(path);
  if (place.in_place()) return check_in_place(path, place);
  struct stat status {};
  if (stat(place.path.c_str(), &status) == 0 && S_ISDIR(status.st_mode))
    return cannot_write(path, EISDIR);
  const std::string growing = growing_name(path);
  const RemovedAtSignal removed(growing);
  std::FILE* file = std::fopen(growing.c_str(), "wb");
  if (file == nullptr) return cannot_write(path, errno);
  std::fclose(file);
  std::remove(growing.c_str());
  return std::nullopt;
}

}  // namespace capsoc::host
