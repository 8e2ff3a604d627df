#include "host/places.h"

#include <algorithm>
#include <filesystem>
#include <initializer_list>

namespace capsoc::host {
namespace {

namespace fs = std::filesystem;

std::string shown(const fs::path& path) {
  std::error_code ignored;
  const fs::path whole = fs::weakly_canonical(path, ignored);
  const fs::path near = fs::proximate(whole, ignored);  // empty if there is no current folder
  return (near.empty() || *near.begin() == ".." ? whole : near).string();
}

/// The first of `folders`, relative to the program's, that has `name`.
std::string found(const std::string& name, std::initializer_list<const char*> folders) {
  const fs::path own = fs::path(program_path()).parent_path();
  for (const char* folder : folders) {
    const fs::path path = own / folder / name;
    std::error_code ignored;
    if (fs::exists(path, ignored)) return shown(path);
  }
  return (own / name).string();
}

}  // namespace

std::string program_path() {
  std::error_code ignored;
  return fs::read_symlink("/proc/self/exe", ignored).string();
}

std::string data_path(const std::string& relative) {
  return found(relative, {"", CAPSOC_DATA_FROM_PROGRAM, ".."});
}

std::string library_path(const std::string& name) {
  return found(name, {"", CAPSOC_LIBRARIES_FROM_PROGRAM, "..", "../..", "../../.."});
}

std::vector<fs::path> files_in(const fs::path& folder, const fs::path& ending) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator each(folder, error), end; !error && each != end;
       each.increment(error))
    if (each->path().extension() == ending && each->is_regular_file(error))
      files.push_back(each->path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace capsoc::host
