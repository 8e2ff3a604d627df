#include "base/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace capsoc {
namespace {

/// Closed at the end of its scope.
class OpenFile {
 public:
  // Non-blocking: a pipe without a writer must not block the program.
  explicit OpenFile(const std::string& path)
      : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)) {}
  ~OpenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  int get() const { return descriptor_; }
  int release() { return std::exchange(descriptor_, -1); }

 private:
  int descriptor_;
};

/// What a file is if it is no regular one; null if it is.
const char* other_kind(mode_t mode) {
  if (S_ISREG(mode)) return nullptr;
  if (S_ISDIR(mode)) return "is a directory";
  if (S_ISFIFO(mode)) return "is a pipe, and only files are read";
  if (S_ISSOCK(mode)) return "is a socket, and only files are read";
  return "is a device, and only files are read";
}

/// Why the file cannot be an input, or "".
std::string objection(const OpenFile& file, const InputLimits& limits) {
  if (file.get() < 0) return std::string("cannot be read (") + std::strerror(errno) + ")";
  struct stat status {};
  if (fstat(file.get(), &status) != 0)
    return std::string("cannot be read (") + std::strerror(errno) + ")";
  if (const char* kind = other_kind(status.st_mode)) return kind;
  const auto size = static_cast<uint64_t>(status.st_size);
  if (size > limits.largest)
    return "has " + std::to_string(size) + " bytes, and at most " + std::to_string(limits.largest) +
           " are read";
  return "";
}

Error refused(const std::string& path, const std::string& what, const InputLimits& limits) {
  return Error{path + ": " + what + "; " + limits.advice};
}

}  // namespace

Result<InputFile> InputFile::open(const std::string& path, const InputLimits& limits) {
  OpenFile file(path);
  if (const std::string what = objection(file, limits); !what.empty())
    return refused(path, what, limits);
  struct stat status {};
  // The kernel's own files have no size and are not empty.
  if (!limits.may_be_empty && fstat(file.get(), &status) == 0 && status.st_size == 0) {
    char first = 0;
    if (::pread(file.get(), &first, 1, 0) == 0) return refused(path, "is empty", limits);
  }
  return InputFile(path, limits, file.release());
}

InputFile::InputFile(InputFile&& other) noexcept
    : path_(std::move(other.path_)),
      limits_(std::move(other.limits_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      taken_(other.taken_) {}

InputFile::~InputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<std::size_t> InputFile::read(char* bytes, std::size_t size) {
  ssize_t got = 0;
  do {
    got = ::read(descriptor_, bytes, size);
  } while (got < 0 && errno == EINTR);
  if (got < 0)
    return refused(path_, std::string("cannot be read (") + std::strerror(errno) + ")", limits_);
  taken_ += static_cast<uint64_t>(got);
  if (taken_ > limits_.largest)
    return refused(path_,
                   "has more than the " + std::to_string(limits_.largest) + " bytes that are read",
                   limits_);
  return static_cast<std::size_t>(got);
}

Result<std::string> read_input(const std::string& path, const InputLimits& limits) {
  auto file = InputFile::open(path, limits);
  if (!file) return Error{file.error()};
  // To its end and not by its size: the kernel's own files have none, and a file may be growing.
  std::string text;
  std::array<char, 1U << 14U> piece;  // few new pages of the stack
  for (;;) {
    const auto got = file.value().read(piece.data(), piece.size());
    if (!got) return Error{got.error()};
    if (got.value() == 0) break;
    text.append(piece.data(), got.value());
  }
  if (text.empty() && !limits.may_be_empty) return refused(path, "is empty", limits);
  return text;
}

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  if (text.substr(0, mark.size()) == mark) text.remove_prefix(mark.size());
  return text;
}

std::optional<Error> check_input(const std::string& path, const InputLimits& limits) {
  const OpenFile file(path);
  if (const std::string what = objection(file, limits); !what.empty())
    return refused(path, what, limits);
  struct stat status {};
  if (!limits.may_be_empty && fstat(file.get(), &status) == 0 && status.st_size == 0)
    return refused(path, "is empty", limits);
  return std::nullopt;
}

}  // namespace capsoc
