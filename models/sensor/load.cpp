#include "sensor/load.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "sensor/described_source.h"
#include "sensor/recorded_source.h"
#include "sensor/toml_reader.h"

namespace capsoc::sensor {

extern const std::string_view built_in_description;  // made from traces/soc_eq21.toml

namespace {

// A description is a page; a recording of a gigabyte is a day at 250 samples a second.
constexpr uintmax_t largest_description = 1u << 20;
constexpr uintmax_t largest_recording = 1u << 30;

Result<std::string> read_file(const std::string& path, uintmax_t largest) {
  std::error_code status;
  if (std::filesystem::is_directory(path, status)) {
    return Error{fmt::format("{}: this is a directory; give a .toml or .csv file", path)};
  }
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return Error{fmt::format("{}: cannot be opened ({}); check the path and its permissions", path,
                             std::strerror(errno ? errno : EIO))};
  }
  const uintmax_t size = std::filesystem::file_size(path, status);
  if (!status && size > largest) {
    return Error{fmt::format("{}: the file has {} bytes; at most {} are read, shorten it", path,
                             size, largest)};
  }
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (file.bad()) return Error{fmt::format("{}: reading failed; check the disk", path)};
  return text;
}

Result<std::unique_ptr<Source>> load_description(const std::string& path) {
  const auto own = built_in(path);
  const Result<std::string> text =
      own ? Result<std::string>(std::string(*own)) : read_file(path, largest_description);
  if (!text) return Error{text.error()};
  Result<SignalConfig> config = read_signal_toml(text.value(), path);
  if (!config) return Error{config.error()};
  return std::unique_ptr<Source>(std::make_unique<DescribedSource>(config.value()));
}

Result<std::unique_ptr<Source>> load_recording(const std::string& path) {
  const Result<std::string> text = read_file(path, largest_recording);
  if (!text) return Error{text.error()};
  Result<RecordedSource> recording = read_recording(text.value(), path);
  if (!recording) return Error{recording.error()};
  return std::unique_ptr<Source>(std::make_unique<RecordedSource>(std::move(recording.value())));
}

}  // namespace

std::optional<std::string_view> built_in(const std::string& name) {
  if (name != built_in_default) return std::nullopt;
  return built_in_description;
}

Result<std::unique_ptr<Source>> load(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".toml") return load_description(path);
  if (extension == ".csv") return load_recording(path);
  return Error{fmt::format(
      "{}: the kind of file is not known; name it .toml (description) or .csv (recording)", path)};
}

}  // namespace capsoc::sensor
