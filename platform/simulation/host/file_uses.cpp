#include "host/file_uses.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "base/printable.h"
#include "host/link_target.h"

namespace capsoc::host {
namespace {

namespace fs = std::filesystem;

/// Where a name leads to, whether or not something is there.
fs::path real_path(const std::string& name, std::error_code& error) {
  return fs::weakly_canonical(fs::absolute(name, error), error);
}

/// Two files with the same text here are one; "": with none.
std::string identity(const struct stat& status) {
  const bool counts = S_ISREG(status.st_mode) || S_ISDIR(status.st_mode);
  return counts ? fmt::format("{}:{}", status.st_dev, status.st_ino) : "";
}

std::string identity(const std::string& name) {
  const Place place = place_of(name);
  if (place.in_place()) return "";
  struct stat status {};
  if (stat(place.path.c_str(), &status) == 0) return identity(status);
  std::error_code error;
  return real_path(place.path, error).string();
}

struct Known {
  FileUse use;
  std::string identity;
  bool standard = false;  ///< a stream that the shell has opened
};

std::vector<Known> standard_streams() {
  std::vector<Known> streams;
  const auto add = [&](int number, FileUse::Kind kind, const char* name) {
    struct stat status {};
    if (fstat(number, &status) == 0 && S_ISREG(status.st_mode))
      streams.push_back({{kind, name, ""}, identity(status), true});
  };
  add(STDIN_FILENO, FileUse::Kind::input, "standard input");
  add(STDOUT_FILENO, FileUse::Kind::output, "standard output");
  add(STDERR_FILENO, FileUse::Kind::output, "standard error");
  return streams;
}

std::string words(const FileUse& use) {
  return use.path.empty() ? use.name : use.name + " " + use.path;
}

}  // namespace

std::optional<Error> check_uses(const std::vector<FileUse>& uses) {
  std::vector<Known> known = standard_streams();
  for (const FileUse& use : uses) {
    if (use.path.empty()) continue;
    const Known now{use, identity(use.path)};
    for (const Known& other : known) {
      if (now.identity.empty() || now.identity != other.identity) continue;
      const bool writes = now.use.kind == FileUse::Kind::output;
      if (!writes && other.use.kind == FileUse::Kind::input) continue;
      const Known& output = writes ? now : other;
      const Known& second = writes ? other : now;
      const std::string where = output.standard ? second.use.name : output.use.name;
      return Error{fmt::format("{} and {} are the same file; name another one for {}",
                               words(output.use), words(second.use), where)};
    }
    known.push_back(now);
  }
  return std::nullopt;
}

std::optional<Error> check_within(const std::vector<FileUse>& uses, const std::string& folder) {
  std::error_code error;
  const fs::path root = fs::canonical(folder, error);
  for (const FileUse& use : uses) {
    if (use.kind != FileUse::Kind::output || use.path.empty()) continue;
    std::error_code unknown;
    const fs::path real = real_path(place_of(use.path).path, unknown);
    if (real == "/dev/null") continue;
    const auto [end, after] = std::mismatch(root.begin(), root.end(), real.begin(), real.end());
    if (error || unknown || end != root.end() || after == real.end())
      return Error{
          fmt::format("{} {} is not below {}, where clients of this session may write; "
                      "name a file there, or start it with --write FOLDER",
                      use.name, printable(use.path, 200), folder)};
  }
  return std::nullopt;
}

const FileUse* shared_output(const std::vector<FileUse>& uses, const std::vector<FileUse>& others) {
  const auto identity_of = [](const FileUse& use) {
    return use.kind == FileUse::Kind::output && !use.path.empty() ? identity(use.path) : "";
  };
  std::set<std::string> known;
  if (!uses.empty())
    for (const FileUse& other : others) known.insert(identity_of(other));
  known.erase("");
  for (const FileUse& use : uses)
    if (known.count(identity_of(use)) > 0) return &use;
  return nullptr;
}

}  // namespace capsoc::host
