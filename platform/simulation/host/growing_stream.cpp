#include "host/growing_stream.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <utility>

#include "host/link_target.h"

namespace capsoc::host {
namespace {

constexpr std::size_t piece = std::size_t{1} << 16;

/// All of it at that offset; false with errno.
bool write_at(int file, std::string_view text, off_t offset) {
  while (!text.empty()) {
    const ssize_t count = pwrite(file, text.data(), text.size(), offset);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(count));
    offset += count;
  }
  return true;
}

}  // namespace

GrowingStream::GrowingStream(const std::string& path, Stream stream, bool in_place)
    : file_(path), stream_(std::move(stream)), in_place_(in_place) {}

Result<GrowingStream> GrowingStream::open(const std::string& path) {
  if (auto error = check_writable(path)) return *error;
  const bool in_place = place_of(path).in_place();
  // "w+": shrink() reads it, too.
  std::FILE* stream = in_place ? std::tmpfile() : std::fopen(growing_name(path).c_str(), "w+be");
  if (stream == nullptr) return cannot_write(path, errno);
  return GrowingStream(path, Stream(stream, std::fclose), in_place);
}

void GrowingStream::fail() {
  if (error_ == 0) error_ = errno != 0 ? errno : EIO;
}

void GrowingStream::write(std::string_view text) {
  if (error_ != 0) return;
  if (std::fwrite(text.data(), 1, text.size(), stream_.get()) != text.size()) fail();
}

void GrowingStream::shrink(const Rewrite& rewrite) {
  if (error_ != 0) return;
  if (std::fflush(stream_.get()) != 0) return fail();
  const int file = fileno(stream_.get());
  std::array<char, piece> buffer{};
  std::string text;
  off_t read_to = 0, written_to = 0;
  for (;;) {
    const ssize_t count = pread(file, buffer.data(), buffer.size(), read_to);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return fail();
    if (count == 0) break;
    read_to += count;
    text.clear();
    rewrite({buffer.data(), static_cast<std::size_t>(count)}, text);
    if (!write_at(file, text, written_to)) return fail();
    written_to += static_cast<off_t>(text.size());
  }
  if (ftruncate(file, written_to) != 0) return fail();
}

bool GrowingStream::copy_to_place() {
  const Stream place(open_growing(file_.path()), std::fclose);
  if (place == nullptr) return false;
  std::rewind(stream_.get());
  std::array<char, piece> buffer{};
  for (;;) {
    const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), stream_.get());
    if (count == 0) break;
    if (std::fwrite(buffer.data(), 1, count, place.get()) != count) return false;
  }
  return std::ferror(stream_.get()) == 0 && std::fflush(place.get()) == 0;
}

std::optional<Error> GrowingStream::finish() {
  if (error_ == 0 && std::fflush(stream_.get()) != 0) fail();
  if (error_ == 0 && in_place_ && !copy_to_place()) fail();
  if (std::fclose(stream_.release()) != 0) fail();
  if (error_ != 0) return cannot_write(file_.path(), error_);
  return file_.name();
}

}  // namespace capsoc::host
