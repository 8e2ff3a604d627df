#include "semihosting/guest_files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>
#include <vector>

namespace capsoc::semihosting {
namespace {

constexpr int as_folder = O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;

/// By the mode without its `b`.
constexpr std::array<int, 6> open_flags = {O_RDONLY,
                                           O_RDWR,
                                           O_WRONLY | O_CREAT | O_TRUNC,
                                           O_RDWR | O_CREAT | O_TRUNC,
                                           O_WRONLY | O_CREAT | O_APPEND,
                                           O_RDWR | O_CREAT | O_APPEND};

std::vector<std::string> parts_of(const std::string& name) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at <= name.size();) {
    const std::size_t end = std::min(name.find('/', at), name.size());
    if (end != at && name.substr(at, end - at) != ".") parts.push_back(name.substr(at, end - at));
    at = end + 1;
  }
  return parts;
}

}  // namespace

Result<GuestFiles> GuestFiles::in(const std::string& directory) {
  GuestFiles files;
  files.directory_.reset(::open(directory.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (files.directory_.valid()) return files;
  return Error{fmt::format("{}: cannot be opened ({}); name a directory for the guest's files",
                           directory, std::strerror(errno))};
}

/// Descends folder by folder, so that no link is followed even if another process changes the tree.
int GuestFiles::find(const std::string& name, Place& place) const {
  if (!directory_.valid() || name.empty() || name[0] == '/') return -EACCES;
  std::vector<std::string> parts = parts_of(name);
  if (parts.empty()) return -EISDIR;
  place.name = parts.back();
  parts.pop_back();
  if (place.name == "..") return -EACCES;
  place.folder.reset(fcntl(directory_.get(), F_DUPFD_CLOEXEC, 0));
  for (const std::string& part : parts) {
    if (part == "..") return -EACCES;
    host::Descriptor next(openat(place.folder.get(), part.c_str(), as_folder));
    if (!next.valid()) return -errno;
    place.folder = std::move(next);
  }
  return place.folder.valid() ? 0 : -EMFILE;
}

int GuestFiles::open(const std::string& name, unsigned mode, host::Descriptor& file) const {
  if (mode / 2 >= open_flags.size()) return -EINVAL;
  return open_with(name, open_flags[mode / 2], file);
}

int GuestFiles::reopen(const std::string& name, unsigned mode, uint64_t size, uint64_t position,
                       host::Descriptor& file) const {
  if (mode / 2 >= open_flags.size()) return -EINVAL;
  const int flags = open_flags[mode / 2] & ~(O_CREAT | O_TRUNC);
  if (const int error = open_with(name, flags, file); error < 0) return error;
  struct stat status {};
  if (fstat(file.get(), &status) != 0) return -errno;
  if (static_cast<uint64_t>(status.st_size) < size) return -ESTALE;
  return lseek(file.get(), static_cast<off_t>(position), SEEK_SET) < 0 ? -errno : 0;
}

void GuestFiles::cut(const host::Descriptor& file, uint64_t size) {
  const int flags = fcntl(file.get(), F_GETFL);
  if (flags < 0 || (flags & O_ACCMODE) == O_RDONLY) return;
  // A file that cannot be cut keeps what it has: the guest overwrites it.
  if (ftruncate(file.get(), static_cast<off_t>(size)) != 0) errno = 0;
}

int GuestFiles::open_with(const std::string& name, int flags, host::Descriptor& file) const {
  Place place;
  if (const int error = find(name, place); error < 0) return error;
  // O_NONBLOCK: a FIFO must not hold the run.
  host::Descriptor opened(openat(place.folder.get(), place.name.c_str(),
                                 flags | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC, 0666));
  if (!opened.valid()) return -errno;
  struct stat status {};
  if (fstat(opened.get(), &status) != 0 || !S_ISREG(status.st_mode)) return -EACCES;
  file = std::move(opened);
  return 0;
}

int GuestFiles::remove(const std::string& name) const {
  Place place;
  if (const int error = find(name, place); error < 0) return error;
  return unlinkat(place.folder.get(), place.name.c_str(), 0) == 0 ? 0 : -errno;
}

int GuestFiles::rename(const std::string& from, const std::string& to) const {
  Place old_place, new_place;
  if (const int error = find(from, old_place); error < 0) return error;
  if (const int error = find(to, new_place); error < 0) return error;
  const int done = renameat(old_place.folder.get(), old_place.name.c_str(), new_place.folder.get(),
                            new_place.name.c_str());
  return done == 0 ? 0 : -errno;
}

ssize_t GuestFiles::write(const host::Descriptor& file, const void* data, std::size_t size) {
  const off_t at = lseek(file.get(), 0, SEEK_CUR);
  if (at < 0) return -errno;
  if (static_cast<uint64_t>(at) + size > largest_file) return -EFBIG;
  if (written_ + size > most_written) return -ENOSPC;
  const ssize_t done = ::write(file.get(), data, size);
  if (done < 0) return -errno;
  written_ += static_cast<uint64_t>(done);
  return done;
}

}  // namespace capsoc::semihosting
