#include "host/files.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace capsoc::host {
namespace {

bool is_special(const std::string& path) {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode);
}

std::optional<Error> write_temporary(const TextFile& file) {
  std::FILE* stream = std::fopen(growing_name(file.path).c_str(), "wb");
  if (stream == nullptr) return cannot_write(file.path, errno);
  const bool written =
      std::fwrite(file.text.data(), 1, file.text.size(), stream) == file.text.size();
  const int write_error = errno;
  if (std::fclose(stream) != 0 || !written)
    return cannot_write(file.path, written ? errno : write_error);
  return std::nullopt;
}

std::optional<Error> write_and_rename(const std::vector<TextFile>& files) {
  for (const TextFile& file : files)
    if (auto error = write_temporary(file)) return error;
  for (const TextFile& file : files)
    if (auto error = name_grown(file.path)) return error;
  return std::nullopt;
}

}  // namespace

Error cannot_write(const std::string& path, int error) {
  return Error{
      fmt::format("{}: cannot be written ({}); name another file", path, std::strerror(error))};
}

std::string growing_name(const std::string& path) {
  return is_special(path) ? path : fmt::format("{}.{}.tmp", path, getpid());
}

std::optional<Error> name_grown(const std::string& path) {
  if (is_special(path) || std::rename(growing_name(path).c_str(), path.c_str()) == 0)
    return std::nullopt;
  return cannot_write(path, errno);
}

void discard_grown(const std::string& path) {
  if (!is_special(path)) std::remove(growing_name(path).c_str());
}

std::optional<Error> write_together(const std::vector<TextFile>& files) {
  for (const TextFile& file : files)  // a rename onto a directory would fail half-way
    if (auto error = check_writable(file.path)) return error;
  auto error = write_and_rename(files);
  if (error)
    for (const TextFile& file : files) discard_grown(file.path);
  return error;
}

std::optional<Error> write_whole(const std::string& path, const std::string& text) {
  return write_together({{path, text}});
}

std::optional<Error> check_writable(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode))
    return cannot_write(path, EISDIR);
  std::FILE* file = std::fopen(growing_name(path).c_str(), "wb");
  if (file == nullptr) return cannot_write(path, errno);
  std::fclose(file);
  discard_grown(path);
  return std::nullopt;
}

}  // namespace capsoc::host
