#include "report/picture.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <memory>

#include "host/files.h"
#include "report/drawing.h"

extern char** environ;

namespace capsoc::report {
namespace {

/// Runs rsvg-convert with the picture on its standard input.
bool convert(const std::string& svg, const std::string& place) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> input(std::tmpfile(), std::fclose);
  if (input == nullptr) return false;
  if (std::fwrite(svg.data(), 1, svg.size(), input.get()) != svg.size()) return false;
  std::rewind(input.get());
  std::array<std::string, 5> words = {"rsvg-convert", "--format=png", "--zoom=2", "--output",
                                      place};
  std::array<char*, words.size() + 1> arguments{};
  for (std::size_t i = 0; i < words.size(); ++i) arguments.at(i) = words.at(i).data();
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, fileno(input.get()), 0);
  pid_t child = 0;
  const bool started =
      posix_spawnp(&child, arguments[0], &files, nullptr, arguments.data(), environ) == 0;
  posix_spawn_file_actions_destroy(&files);
  int status = 0;
  return started && waitpid(child, &status, 0) == child && WIFEXITED(status) &&
         WEXITSTATUS(status) == 0;
}

}  // namespace

std::string svg_of(const Figure& figure, const Data& data) {
  return Drawing(figure, data).picture();
}

std::optional<Error> write_picture(const std::string& path, const std::string& svg) {
  constexpr std::string_view png = ".png";
  if (path.size() < png.size() || path.compare(path.size() - png.size(), png.size(), png) != 0)
    return host::write_whole(path, svg);
  host::GrowingFile file(path);
  if (!convert(svg, file.growing()))
    return Error{fmt::format(
        "{}: rsvg-convert makes PNG and could not; install librsvg2-bin, or take a .svg", path)};
  return file.name();
}

}  // namespace capsoc::report
