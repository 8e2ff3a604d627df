#include "trace/line_file.h"

#include <cerrno>
#include <utility>

namespace capsoc::trace {

LineFile::LineFile(const std::string& path, std::size_t depth) : growing_(path), depth_(depth) {}

Result<std::unique_ptr<LineFile>> LineFile::open(const std::string& path, std::size_t depth) {
  if (auto error = host::check_writable(path)) return *error;
  std::unique_ptr<LineFile> file(new LineFile(path, depth));
  file->file_ = host::open_growing(path);
  if (file->file_ == nullptr) return host::cannot_write(path, errno);
  return file;
}

LineFile::~LineFile() {
  if (file_ != nullptr) std::fclose(file_);
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
  if (error_ == 0) return growing_.name();
  return host::cannot_write(growing_.path(), error_);
}

}  // namespace capsoc::trace
