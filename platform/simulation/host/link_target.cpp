#include "host/link_target.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>

namespace capsoc::host {
namespace {

namespace fs = std::filesystem;

constexpr int longest_chain = 40;  // as the kernel has it

bool is_number(const std::string& text) {
  return !text.empty() && text.size() < 9 && std::all_of(text.begin(), text.end(), [](char c) {
    return std::isdigit(static_cast<unsigned char>(c)) != 0;
  });
}

/// Whether a folder is /proc/N/fd; N, or 0.
pid_t process_of(const fs::path& folder) {
  std::error_code error;
  const fs::path real = fs::canonical(folder, error);
  if (error || real.filename() != "fd") return 0;
  fs::path process = real.parent_path();
  if (process.parent_path().filename() == "task") process = process.parent_path().parent_path();
  const bool in_proc = process.parent_path() == "/proc" && is_number(process.filename().string());
  return in_proc ? std::atoi(process.filename().c_str()) : 0;
}

}  // namespace

Place place_of(const std::string& name) {
  Place place;
  if (name == "-") return {"/dev/stdout", STDOUT_FILENO, true};
  fs::path path(name);
  std::error_code error;
  for (int i = 0; i < longest_chain && fs::is_symlink(fs::symlink_status(path, error)); ++i) {
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    if (const pid_t process = process_of(folder); process != 0) {
      // The link's text is for people; what it stands for is the open file.
      place.special = true;
      if (process == getpid() && is_number(path.filename().string()))
        place.descriptor = std::atoi(path.filename().c_str());
      break;
    }
    const fs::path target = fs::read_symlink(path, error);
    if (error) break;
    path = target.is_absolute() ? target : folder / target;
  }
  struct stat status {};
  place.path = path.string();
  if (stat(place.path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) &&
      !S_ISDIR(status.st_mode))
    place.special = true;
  return place;
}

}  // namespace capsoc::host
