// capsoc new: a custom firmware project, complete.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "base/printable.h"
#include "base/result.h"
#include "base/shell.h"
#include "cli/commands.h"
#include "cli/refuse.h"
#include "host/console.h"
#include "host/files.h"
#include "host/places.h"
#include "soc/board_registers.h"

namespace capsoc::cli {
namespace {

namespace fs = std::filesystem;

/// A part of the project and where it comes from.
struct Part {
  const char* from;  ///< of the program's data: a file, or a folder that is taken with all in it
  const char* to;
};
constexpr Part parts[] = {
    {"template", ""},
    {"sources/common", "board"},
    {"sources/drivers", "drivers"},
    {"include/capsoc_device.h", "board/capsoc_device.h"},
    {"gdb/svd.py", "debug/svd.py"},
};

std::string reason(const std::error_code& failure) {
  return failure.message();
}

std::optional<Error> refuse_place(const fs::path& place) {
  std::error_code failure;
  const fs::file_status status = fs::status(place, failure);
  if (!fs::exists(status)) return std::nullopt;
  const std::string name = printable(place.string(), 200);
  if (!fs::is_directory(status))
    return Error{fmt::format("{}: is a file; name a folder that is not there yet", name)};
  const bool empty = fs::is_empty(place, failure);
  if (failure)
    return Error{
        fmt::format("{}: cannot be read ({}); name another folder", name, reason(failure))};
  if (!empty)
    return Error{
        fmt::format("{}: is there and not empty; name a folder that is not there yet", name)};
  return std::nullopt;
}

/// Installed files may be read-only; these are to be changed.
void make_writable(const fs::path& path) {
  std::error_code ignored;
  fs::permissions(path, fs::perms::owner_write, fs::perm_options::add, ignored);
}

std::error_code bring_file(const fs::path& from, const fs::path& to) {
  std::error_code failure;
  fs::create_directories(to.parent_path(), failure);
  if (failure) return failure;
  fs::copy_file(from, to, failure);
  if (!failure) make_writable(to);
  return failure;
}

std::error_code bring_part(const fs::path& from, const fs::path& to) {
  if (!fs::is_directory(from)) return bring_file(from, to);
  std::error_code failure;
  for (fs::recursive_directory_iterator at(from, failure), end; !failure && at != end;
       at.increment(failure))
    if (at->is_regular_file(failure) && !failure)
      failure = bring_file(at->path(), to / fs::relative(at->path(), from));
  return failure;
}

/// For the debugger and the IDE.
std::optional<Error> write_registers(const fs::path& file) {
  // SystemC prints its own notes on stdout.
  sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
  const soc::Soc soc("soc", {});
  return host::write_whole(file.string(), soc::board_svd(soc));
}

std::optional<Error> copy_all(const fs::path& place) {
  for (const Part& part : parts) {
    const fs::path from = host::data_path(part.from);
    std::error_code failure;
    if (!fs::exists(from, failure))
      return Error{fmt::format(
          "{}: is not there; keep the folders that came with capsoc next to it, and build again "
          "where a build tree was moved",
          from.string())};
    failure = bring_part(from, *part.to == '\0' ? place : place / part.to);
    if (failure)
      return Error{fmt::format("{}: cannot be written ({}); name another folder",
                               printable(place.string(), 200), reason(failure))};
  }
  return write_registers(place / "debug/board.svd");
}

int new_command(const std::string& folder) {
  const fs::path place(folder);
  if (auto error = refuse_place(place)) return refuse(error->text);
  std::error_code ignored;
  const bool was_there = fs::exists(place, ignored);
  if (auto error = copy_all(place)) {
    if (!was_there) fs::remove_all(place, ignored);
    return refuse(error->text);
  }
  host::say("{}: a project that prints; build and run it with: make -C {} run\n",
            printable(folder, 400), shell_word(folder));
  return run::exit_code::pass;
}

}  // namespace

void add_new(CLI::App& app, int& code) {
  auto folder = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand(
      "new", "Make your own firmware project: start-up, newlib, drivers, make and CMake, IDE");
  command->add_option("folder", *folder, "Where; it must not be there yet, or be empty")
      ->required()
      ->type_name("DIR");
  command->callback([folder, &code] { code = new_command(*folder); });
}

}  // namespace capsoc::cli
