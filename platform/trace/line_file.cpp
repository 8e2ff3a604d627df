#include "trace/line_file.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace capsoc::trace {
namespace {

/// A device or a pipe is written as it is: there is nothing to rename.
bool is_special(const std::string& path) {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode);
}

Error cannot_write(const std::string& path, int error) {
  return Error{
      fmt::format("{}: cannot be written ({}); name another file", path, std::strerror(error))};
}

}  // namespace

LineFile::LineFile(std::string path, std::size_t depth)
    : path_(std::move(path)),
      temporary_(is_special(path_) ? path_ : fmt::format("{}.{}.tmp", path_, getpid())),
      depth_(depth) {}

Result<std::unique_ptr<LineFile>> LineFile::open(const std::string& path, std::size_t depth) {
  std::unique_ptr<LineFile> file(new LineFile(path, depth));
  file->file_ = std::fopen(file->temporary_.c_str(), "w");
  if (file->file_ == nullptr) return cannot_write(path, errno);
  return file;
}

LineFile::~LineFile() {
  if (file_ == nullptr) return;
  std::fclose(file_);
  if (temporary_ != path_) std::remove(temporary_.c_str());
}

void LineFile::write(const std::string& line) {
  if (error_ != 0) return;
  if (std::fwrite(line.data(), 1, line.size(), file_) != line.size() ||
      std::fputc('\n', file_) == EOF)
    error_ = errno;
}

void LineFile::put(std::string line) {
  if (depth_ != 0) {
    if (kept_.size() == depth_) kept_.pop_front();
    kept_.push_back(std::move(line));
    return;
  }
  if (!heading_.empty()) write(heading_);
  heading_.clear();
  write(line);
}

std::optional<Error> LineFile::finish() {
  if (!heading_.empty()) write(heading_);
  for (const std::string& line : kept_) write(line);
  if (std::fclose(file_) != 0 && error_ == 0) error_ = errno;
  file_ = nullptr;
  if (error_ == 0 && temporary_ != path_ && std::rename(temporary_.c_str(), path_.c_str()) != 0)
    error_ = errno;
  if (error_ == 0) return std::nullopt;
  if (temporary_ != path_) std::remove(temporary_.c_str());
  return cannot_write(path_, error_);
}

}  // namespace capsoc::trace
