#include "trace/line_file.h"

#include <cerrno>
#include <utility>

#include "host/files.h"

namespace capsoc::trace {

LineFile::LineFile(std::string path, std::size_t depth) : path_(std::move(path)), depth_(depth) {}

Result<std::unique_ptr<LineFile>> LineFile::open(const std::string& path, std::size_t depth) {
  std::unique_ptr<LineFile> file(new LineFile(path, depth));
  if (auto error = host::check_writable(path)) return *error;
  file->file_ = std::fopen(host::growing_name(path).c_str(), "w");
  if (file->file_ == nullptr) return host::cannot_write(path, errno);
  return file;
}

LineFile::~LineFile() {
  if (file_ == nullptr) return;
  std::fclose(file_);
  host::discard_grown(path_);
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
  if (error_ == 0) return host::name_grown(path_);
  host::discard_grown(path_);
  return host::cannot_write(path_, error_);
}

}  // namespace capsoc::trace
