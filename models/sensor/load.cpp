#include "sensor/load.h"

#include <fmt/format.h>

#include <filesystem>

#include "sensor/described_source.h"
#include "sensor/recorded_source.h"
#include "sensor/text.h"
#include "sensor/toml_reader.h"
#include "support/input_file.h"
#include "support/printable.h"

namespace capsoc::sensor {

extern const std::string_view built_in_description;  // made from traces/soc_eq21.toml

namespace {

// A description is a page; a recording of a gigabyte is a day at 250 samples a second.
constexpr uint64_t largest_description = 1U << 20U;
constexpr uint64_t largest_recording = 1U << 30U;
constexpr const char* advice = "name a sensor description (.toml) or a recording (.csv)";

Result<std::unique_ptr<Source>> description(const std::string& text, const std::string& name,
                                            const std::vector<KeyValue>& keys) {
  Result<SignalConfig> config = read_signal_toml(text, name, keys);
  if (!config) return Error{config.error()};
  return std::unique_ptr<Source>(std::make_unique<DescribedSource>(config.value()));
}

Result<std::unique_ptr<Source>> recording(const std::string& text, const std::string& name,
                                          const std::vector<KeyValue>& keys) {
  if (!keys.empty())
    return Error{fmt::format("{}: {} is a recording and has no '{}'; only a description has",
                             keys.front().origin, name, printable(keys.front().name))};
  Result<RecordedSource> recording = read_recording(text, name);
  if (!recording) return Error{recording.error()};
  return std::unique_ptr<Source>(std::make_unique<RecordedSource>(std::move(recording.value())));
}

/// Whether a text without a name is a description: "[table]" or "key = value", not "u,v".
bool is_description(std::string_view text) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text.substr(0, 3) == byte_order_mark) text.remove_prefix(3);
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    line = trimmed(line);
    if (line.empty() || line.front() == '#') continue;
    return line.front() == '[' || line.find('=') != std::string_view::npos;
  }
  return false;
}

}  // namespace

std::optional<std::string_view> built_in(const std::string& name) {
  if (name != built_in_default) return std::nullopt;
  return built_in_description;
}

Result<std::unique_ptr<Source>> load(const std::string& path, const std::vector<KeyValue>& keys) {
  if (const auto own = built_in(path)) return description(std::string(*own), path, keys);
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension != ".toml" && extension != ".csv")
    return Error{fmt::format(
        "{}: the kind of file is not known; name it .toml (description) or .csv (recording)",
        path)};
  const bool described = extension == ".toml";
  const Result<std::string> text =
      read_input(path, {advice, described ? largest_description : largest_recording});
  if (!text) return Error{text.error()};
  return described ? description(text.value(), path, keys) : recording(text.value(), path, keys);
}

Result<std::unique_ptr<Source>> load_text(const std::string& text, const std::string& name,
                                          const std::vector<KeyValue>& keys) {
  if (!is_description(text)) return recording(text, name, keys);
  if (text.size() <= largest_description) return description(text, name, keys);
  return Error{fmt::format("{}: {} bytes are no description; at most {} are read, shorten it", name,
                           text.size(), largest_description)};
}

}  // namespace capsoc::sensor
