#include "trace/source_paths.h"

namespace capsoc::trace {
namespace {

namespace fs = std::filesystem;

std::optional<std::string> existing(const fs::path& path) {
  std::error_code failure;
  const fs::path normal = path.lexically_normal();
  if (fs::is_regular_file(normal, failure)) return normal.string();
  // "link/../file" is next to what the link points to.
  const fs::path real = fs::canonical(path, failure);
  if (failure || !fs::is_regular_file(real, failure)) return std::nullopt;
  return real.string();
}

/// What a path has after a folder that it begins with; "" if it does not.
fs::path behind(const fs::path& folder, const fs::path& path) {
  const std::string begin = folder.lexically_normal().string() + "/";
  const std::string whole = path.lexically_normal().string();
  return whole.rfind(begin, 0) == 0 ? whole.substr(begin.size()) : "";
}

}  // namespace

SourcePaths::SourcePaths(const std::string& program) {
  std::error_code ignored;
  places_.push_back(fs::current_path(ignored));
  fs::path folder = fs::absolute(program, ignored).lexically_normal().parent_path();
  for (; folder.has_relative_path(); folder = folder.parent_path()) places_.push_back(folder);
}

std::optional<std::string> SourcePaths::find(const source::SourceFile& file) const {
  const fs::path name(file.name), folder(file.folder);
  if (name.empty()) return std::nullopt;
  if (name.is_absolute()) return existing(name);
  if (folder.is_absolute()) {
    if (auto path = existing(folder / name)) return path;
    if (file.name.rfind("./", 0) != 0) return std::nullopt;
  }
  for (const fs::path& place : places_) {
    if (auto path = folder.is_absolute() ? std::nullopt : existing(place / folder / name))
      return path;
    if (auto path = existing(place / name)) return path;
    // Clang maps an absolute name, and libdw puts the folder in front of it again.
    if (auto path = existing(place / behind(folder, name))) return path;
  }
  std::string normal = name.lexically_normal().string();
  if (normal.rfind("../", 0) == 0) return std::nullopt;
  return normal;
}

}  // namespace capsoc::trace
