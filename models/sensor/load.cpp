#include "sensor/load.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <utility>

#include "base/input_file.h"
#include "base/printable.h"
#include "sensor/described_source.h"
#include "sensor/mat_file.h"
#include "sensor/recorded_source.h"
#include "sensor/sds_file.h"
#include "sensor/text.h"
#include "sensor/text_recording.h"
#include "sensor/toml_reader.h"
#include "sensor/wav_file.h"

namespace capsoc::sensor {

extern const std::string_view built_in_description;  // made from traces/soc_eq21.toml

namespace {

// A description is a page; a recording of a gigabyte is a day at 250 samples a second.
constexpr uint64_t largest_description = 1U << 20U;
constexpr uint64_t largest_recording = 1U << 30U;
constexpr uint64_t largest_metadata = 1U << 20U;
constexpr const char* kinds_of_files =
    "name a sensor description (.toml) or a recording (.csv, .txt, .wav, .mat, .sds)";

using Made = Result<std::unique_ptr<Source>>;

std::string ending_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

bool is_text_ending(const std::string& ending) {
  constexpr const char* endings[] = {".csv", ".txt", ".tsv", ".tab",
                                     ".dat", ".asc", ".lvm", ".log"};
  return std::any_of(std::begin(endings), std::end(endings),
                     [&](const char* one) { return ending == one; });
}

Made description(const std::string& text, const std::string& name,
                 const std::vector<KeyValue>& keys, const RecordingOptions& options) {
  if (options.any())
    return Error{
        fmt::format("{}: a description has its own columns and units; --columns, "
                    "--full-scale, --zero and --scale are for recordings",
                    name)};
  Result<SignalConfig> config = read_signal_toml(text, name, keys);
  if (!config) return Error{config.error()};
  return std::unique_ptr<Source>(std::make_unique<DescribedSource>(config.value()));
}

std::optional<Error> refuse_keys(const std::string& name, const std::vector<KeyValue>& keys) {
  if (keys.empty()) return std::nullopt;
  return Error{fmt::format("{}: {} is a recording and has no '{}'; only a description has",
                           keys.front().origin, name, printable(keys.front().name))};
}

std::optional<Error> check_options(const RecordingOptions& options) {
  if (options.automatic_scale && (options.full_scale || options.zero))
    return Error{"--scale auto finds --full-scale and --zero by itself; give one or the other"};
  if (options.full_scale && *options.full_scale == 0)
    return Error{"--full-scale 0 is no range of values; give the value that is 1 of full scale"};
  return std::nullopt;
}

Made made(Result<RecordedSource> recording) {
  if (!recording) return Error{recording.error()};
  return std::unique_ptr<Source>(std::make_unique<RecordedSource>(std::move(recording.value())));
}

Result<RecordedSource> from_table(const Result<ColumnTable>& table, const std::string& name,
                                  const RecordingOptions& options) {
  if (!table) return Error{table.error()};
  return read_table(table.value(), name, options);
}

Result<RecordedSource> text_file(const std::string& path, const RecordingOptions& options) {
  auto lines = TextLines::open(path, {kinds_of_files, largest_recording});
  if (!lines) return Error{lines.error()};
  return read_text_recording(std::move(lines.value()), path, options);
}

Result<RecordedSource> sds_files(const std::string& path, const std::string& bytes,
                                 const RecordingOptions& options) {
  std::error_code ignored;
  const std::vector<std::string> candidates = sds_metadata_files(path);
  const auto found =
      std::find_if(candidates.begin(), candidates.end(),
                   [&](const std::string& file) { return std::filesystem::exists(file, ignored); });
  if (found == candidates.end())
    return Error{fmt::format("{}: its metadata {} is not there; put it next to the recording", path,
                             candidates.empty() ? "NAME.sds.yml" : candidates.back())};
  const auto text = read_input(*found, {"name SDS metadata", largest_metadata});
  if (!text) return Error{text.error()};
  const auto metadata = read_sds_metadata(text.value(), *found);
  if (!metadata) return Error{metadata.error()};
  return from_table(read_sds(bytes, metadata.value(), path), path, options);
}

Result<RecordedSource> binary_file(const std::string& path, const std::string& ending,
                                   const RecordingOptions& options) {
  const auto bytes = read_input(path, {kinds_of_files, largest_recording});
  if (!bytes) return Error{bytes.error()};
  if (ending == ".wav") return from_table(read_wav(bytes.value(), path), path, options);
  if (ending == ".mat") return from_table(read_mat(bytes.value(), path), path, options);
  return sds_files(path, bytes.value(), options);
}

/// Two files, each with one of the signals.
Result<RecordedSource> pair_of_files(const std::string& u, const std::string& v,
                                     const std::string& path, const RecordingOptions& options) {
  for (const std::string& file : {u, v})
    if (!is_text_ending(ending_of(file)))
      return Error{file + ": of two files with a signal each, both are text (.csv, .txt)"};
  auto first = TextLines::open(u, {kinds_of_files, largest_recording});
  if (!first) return Error{first.error()};
  auto second = TextLines::open(v, {kinds_of_files, largest_recording});
  if (!second) return Error{second.error()};
  return read_text_pair(std::move(first.value()), u, std::move(second.value()), v, path, options);
}

/// "U,V" where no file has the whole name: at the comma where both files are there, or else at the
/// only one.
std::vector<std::string> split_pair(const std::string& path) {
  std::error_code ignored;
  if (path.find(',') == std::string::npos || std::filesystem::exists(path, ignored)) return {path};
  for (std::size_t comma = path.find(','); comma != std::string::npos;
       comma = path.find(',', comma + 1)) {
    const std::string u = path.substr(0, comma), v = path.substr(comma + 1);
    if (std::filesystem::exists(u, ignored) && std::filesystem::exists(v, ignored)) return {u, v};
  }
  const std::size_t comma = path.find(',');
  if (comma != path.rfind(',')) return {path};
  return {path.substr(0, comma), path.substr(comma + 1)};
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
    if (line.substr(0, 4) == "sep=") return false;  // Excel's first line of a CSV file
    return line.front() == '[' || line.find('=') != std::string_view::npos;
  }
  return false;
}

}  // namespace

std::optional<std::string_view> built_in(const std::string& name) {
  if (name != built_in_default) return std::nullopt;
  return built_in_description;
}

Made load(const std::string& path, const std::vector<KeyValue>& keys,
          const RecordingOptions& options) {
  if (auto error = check_options(options)) return *error;
  if (const auto own = built_in(path)) return description(std::string(*own), path, keys, options);
  const std::vector<std::string> files = split_pair(path);
  const std::string ending = ending_of(files.back());
  if (ending == ".toml" && files.size() == 1) {
    const auto text = read_input(path, {kinds_of_files, largest_description});
    if (!text) return Error{text.error()};
    return description(text.value(), path, keys, options);
  }
  const bool binary = ending == ".wav" || ending == ".mat" || ending == ".sds";
  if (!binary && !is_text_ending(ending))
    return Error{fmt::format("{}: the kind of file is not known; {}", path, kinds_of_files)};
  if (auto error = refuse_keys(path, keys)) return *error;
  if (files.size() == 2) return made(pair_of_files(files[0], files[1], path, options));
  return made(binary ? binary_file(path, ending, options) : text_file(path, options));
}

Made load_text(const std::string& text, const std::string& name, const std::vector<KeyValue>& keys,
               const RecordingOptions& options) {
  if (auto error = check_options(options)) return *error;
  const bool binary = is_wav(text) || is_mat(text);
  if (!binary && is_description(text)) {
    if (text.size() <= largest_description) return description(text, name, keys, options);
    return Error{fmt::format("{}: {} bytes are no description; at most {} are read, shorten it",
                             name, text.size(), largest_description)};
  }
  if (auto error = refuse_keys(name, keys)) return *error;
  if (is_wav(text)) return made(from_table(read_wav(text, name), name, options));
  if (is_mat(text)) return made(from_table(read_mat(text, name), name, options));
  return made(read_recording(text, name, options));
}

std::vector<std::string> files_of(const std::string& path) {
  std::vector<std::string> files = split_pair(path);
  if (files.size() != 1 || ending_of(path) != ".sds") return files;
  std::error_code ignored;
  for (const std::string& metadata : sds_metadata_files(path)) {
    if (!std::filesystem::exists(metadata, ignored)) continue;
    files.push_back(metadata);
    break;
  }
  return files;
}

}  // namespace capsoc::sensor
