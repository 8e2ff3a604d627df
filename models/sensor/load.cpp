#include "sensor/load.h"

#include <fmt/format.h>

#include <filesystem>

#include "sensor/described_source.h"
#include "sensor/recorded_source.h"
#include "sensor/toml_reader.h"
#include "support/input_file.h"

namespace capsoc::sensor {

extern const std::string_view built_in_description;  // made from traces/soc_eq21.toml

namespace {

// A description is a page; a recording of a gigabyte is a day at 250 samples a second.
constexpr uint64_t largest_description = 1U << 20U;
constexpr uint64_t largest_recording = 1U << 30U;
constexpr const char* advice = "name a sensor description (.toml) or a recording (.csv)";

Result<std::unique_ptr<Source>> load_description(const std::string& path) {
  const auto own = built_in(path);
  const Result<std::string> text = own ? Result<std::string>(std::string(*own))
                                       : read_input(path, {advice, largest_description});
  if (!text) return Error{text.error()};
  Result<SignalConfig> config = read_signal_toml(text.value(), path);
  if (!config) return Error{config.error()};
  return std::unique_ptr<Source>(std::make_unique<DescribedSource>(config.value()));
}

Result<std::unique_ptr<Source>> load_recording(const std::string& path) {
  const Result<std::string> text = read_input(path, {advice, largest_recording});
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
