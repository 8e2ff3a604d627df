#include "host/temporary_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <sys/file.h>

#include <chrono>
#include <filesystem>
#include <utility>

namespace capsoc::host {
namespace {

namespace fs = std::filesystem;

constexpr const char* lock_name = "/owner";
/// A younger one may be about to be locked.
constexpr std::chrono::seconds youngest{60};

/// Its lock is free.
bool is_left_over(const fs::directory_entry& folder, const std::string& beginning) {
  std::error_code failure;
  if (folder.path().filename().string().rfind(beginning, 0) != 0) return false;
  const auto written = folder.last_write_time(failure);
  if (failure || fs::file_time_type::clock::now() - written < youngest) return false;
  const Descriptor lock(open((folder.path().string() + lock_name).c_str(), O_RDWR | O_CLOEXEC));
  return lock.valid() && flock(lock.get(), LOCK_EX | LOCK_NB) == 0;
}

/// A folder of another user stays, and so does one that another process removes now.
void remove_left_over(const fs::path& place, const std::string& beginning) {
  std::error_code failure, ignored;
  for (fs::directory_iterator each(place, failure); !failure && each != fs::end(each);
       each.increment(failure))
    if (is_left_over(*each, beginning)) fs::remove_all(each->path(), ignored);
}

}  // namespace

Result<TemporaryFolder> TemporaryFolder::make(const std::string& name) {
  std::error_code failure;
  const fs::path place = fs::temp_directory_path(failure);
  const std::string beginning = fmt::format("capsoc-{}-", name);
  std::string path = (place / (beginning + "XXXXXX")).string();
  if (failure || mkdtemp(path.data()) == nullptr)
    return Error{fmt::format(
        "{}: no folder for temporary files can be made; set TMPDIR to one with room", path)};
  Descriptor lock(open((path + lock_name).c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600));
  if (!lock.valid()) {
    fs::remove_all(path, failure);
    return Error{fmt::format("{}: cannot be written to; set TMPDIR to a folder with room", path)};
  }
  // Where nothing can be locked, nothing is taken for left over either.
  static_cast<void>(flock(lock.get(), LOCK_EX | LOCK_NB));
  remove_left_over(place, beginning);
  return TemporaryFolder(std::move(path), std::move(lock));
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  if (lock_.valid() && getpid() == owner_) fs::remove_all(path_, ignored);
}

}  // namespace capsoc::host
