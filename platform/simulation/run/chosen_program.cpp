#include "run/chosen_program.h"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <system_error>

#include "host/places.h"
#include "loader/program_file.h"
#include "run/run_settings.h"

namespace capsoc::run {
namespace {

/// A program that nobody named and that is not there: the binary was copied without its files.
std::optional<Error> missing_default(const RunSettings& settings, const std::string& program) {
  std::error_code ignored;
  if (!settings.firmware.elf.is_built_in() || std::filesystem::exists(program, ignored))
    return std::nullopt;
  return Error{fmt::format(
      "{}: the default program is not there; name yours (capsoc run FILE.elf), or keep the folder "
      "firmware/ beside capsoc",
      program)};
}

}  // namespace

std::string program_of(const RunSettings& settings) {
  const bool chosen = !settings.firmware.elf.is_built_in();
  if (settings.firmware.parameters.empty() || chosen) return settings.firmware.elf();
  return host::data_path("firmware/calibrate.elf");
}

Result<loader::ElfImage> read_program(const RunSettings& settings) {
  const std::string file = program_of(settings);
  if (auto error = missing_default(settings, file)) return *error;
  return loader::load_program(file);
}

}  // namespace capsoc::run
