#include "metrics/parameter_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>
#include <vector>

#include "base/input_file.h"

namespace capsoc::metrics {
namespace {

using nlohmann::json;

constexpr uint64_t largest_file = 1U << 24U;
constexpr uint32_t valid = 0x43414C31;  // PARAMETER_BLOCK_VALID

std::vector<uint8_t> to_bytes(const std::vector<uint32_t>& words) {
  std::vector<uint8_t> bytes;
  for (const uint32_t word : words)
    for (int shift = 0; shift < 32; shift += 8)
      bytes.push_back(static_cast<uint8_t>(word >> shift));
  return bytes;
}

struct Entry {
  int64_t word = 0;
  double value = 0;
};

/// One member of `parameters`, its word within `least` .. `greatest`.
Result<Entry> read_entry(const json& parameters, const char* name, int64_t least, int64_t greatest,
                         const std::string& path) {
  const auto found = parameters.find(name);
  if (found == parameters.end() || !found->is_object())
    return Error{
        fmt::format("{}: parameters.{} is missing; write the file with capsoc fit", path, name)};
  const auto word = found->find("word"), value = found->find("value");
  if (word == found->end() || !word->is_number_integer())
    return Error{fmt::format("{}: parameters.{}.word must be a whole number", path, name)};
  if (value == found->end() || !value->is_number())
    return Error{fmt::format("{}: parameters.{}.value must be a number", path, name)};
  const bool huge = word->is_number_unsigned() && word->get<uint64_t>() > INT64_MAX;
  const Entry entry{huge ? INT64_MAX : word->get<int64_t>(), value->get<double>()};
  if (entry.word < least || entry.word > greatest)
    return Error{fmt::format("{}: parameters.{}.word = {} is out of range; {} to {} are legal",
                             path, name, word->dump(), least, greatest)};
  return entry;
}

Error disagreement(const std::string& path, const char* name, const Entry& entry) {
  return Error{
      fmt::format("{}: parameters.{}.word = {} and .value = {} disagree; correct one of them", path,
                  name, entry.word, entry.value)};
}

Result<int32_t> read_fraction(const json& parameters, const char* name, int64_t least,
                              const std::string& path) {
  const Result<Entry> entry = read_entry(parameters, name, least, INT32_MAX, path);
  if (!entry) return Error{entry.error()};
  const double word = entry.value().value * 0x1p31;
  if (!(std::fabs(word - static_cast<double>(entry.value().word)) <= 1))
    return disagreement(path, name, entry.value());
  return static_cast<int32_t>(entry.value().word);
}

/// `capsoc run` and `capsoc fit` print the words of angles unsigned; signed ones mean the same.
Result<uint32_t> read_angle(const json& parameters, const char* name, const std::string& path) {
  const Result<Entry> entry = read_entry(parameters, name, INT32_MIN, UINT32_MAX, path);
  if (!entry) return Error{entry.error()};
  const double turns = entry.value().value / (2 * std::acos(-1.0));
  const double difference =
      std::remainder(turns - static_cast<double>(entry.value().word) * 0x1p-32, 1.0) * 0x1p32;
  if (!(std::fabs(difference) <= 1)) return disagreement(path, name, entry.value());
  return static_cast<uint32_t>(entry.value().word);
}

Result<json> read_json(const std::string& path) {
  const auto read = read_input(path, {"name a file that capsoc fit wrote", largest_file});
  if (!read) return Error{read.error()};
  const std::string& text = read.value();
  std::size_t damaged_at = 0;
  try {
    return json::parse(text);
  } catch (const json::parse_error& error) {
    damaged_at = std::min(error.byte, text.size());
  } catch (const json::exception&) {  // a number that no double holds
  }
  const auto line =
      1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(damaged_at), '\n');
  return Error{
      fmt::format("{}:{}: this is not JSON; write the file again with capsoc fit", path, line)};
}

}  // namespace

Result<ParameterWords> read_parameters(const std::string& path) {
  const Result<json> root = read_json(path);
  if (!root) return Error{root.error()};
  if (!root.value().is_object() || !root.value().contains("parameters") ||
      !root.value()["parameters"].is_object())
    return Error{
        fmt::format("{}: there are no parameters in it; name a file that capsoc fit wrote", path)};
  const json& parameters = root.value()["parameters"];
  ParameterWords words;
  const std::tuple<const char*, int32_t ParameterWords::*, int64_t> fractions[] = {
      {"a1", &ParameterWords::a1, 1},
      {"a2", &ParameterWords::a2, 1},
      {"b1", &ParameterWords::b1, INT32_MIN},
      {"b2", &ParameterWords::b2, INT32_MIN}};
  for (const auto& [name, word, least] : fractions) {
    const Result<int32_t> read = read_fraction(parameters, name, least, path);
    if (!read) return Error{read.error()};
    words.*word = read.value();
  }
  const std::pair<const char*, uint32_t ParameterWords::*> angles[] = {
      {"beta", &ParameterWords::beta}, {"phi", &ParameterWords::phi}};
  for (const auto& [name, word] : angles) {
    const Result<uint32_t> read = read_angle(parameters, name, path);
    if (!read) return Error{read.error()};
    words.*word = read.value();
  }
  return words;
}

Result<std::optional<ErrorTable>> read_error_table(const std::string& path) {
  constexpr int64_t least = -(1 << 19), greatest = (1 << 19) - 1;
  const Result<json> root = read_json(path);
  if (!root) return Error{root.error()};
  const json& file = root.value();
  if (!file.is_object() || !file.contains("error_table")) return std::optional<ErrorTable>();
  const json& table = file["error_table"];
  if (table.is_object() && !table.contains("nodes")) return std::optional<ErrorTable>();
  ErrorTable nodes{};
  if (!table.is_object() || !table["nodes"].is_array() || table["nodes"].size() != nodes.size())
    return Error{fmt::format(
        "{}: error_table.nodes must be a list of {} whole numbers; write the file with capsoc fit",
        path, nodes.size())};
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const json& node = table["nodes"][i];
    const bool whole = node.is_number_integer() &&
                       !(node.is_number_unsigned() && node.get<uint64_t>() > INT64_MAX);
    if (!whole || node.get<int64_t>() < least || node.get<int64_t>() > greatest)
      return Error{fmt::format("{}: error_table.nodes[{}] = {} is not legal; {} to {} are", path, i,
                               node.dump(), least, greatest)};
    nodes[i] = node.get<int32_t>();
  }
  return std::optional<ErrorTable>(nodes);
}

std::optional<Error> write_in_program(loader::ElfImage& image, const ErrorTable& table) {
  std::vector<uint32_t> words = {valid};
  for (const int32_t node : table) words.push_back(static_cast<uint32_t>(node));
  if (image.overwrite("calibration_table", to_bytes(words))) return std::nullopt;
  return Error{
      fmt::format("{}: the program has no place for the error table of --parameters; define "
                  "calibration_table as firmware/apps/common/parameter_block.h has it, or fit "
                  "without --use-angle",
                  image.path)};
}

std::optional<Error> write_in_program(loader::ElfImage& image, const ParameterWords& words) {
  const std::vector<uint8_t> bytes = to_bytes(
      {valid, static_cast<uint32_t>(words.a1), static_cast<uint32_t>(words.a2),
       static_cast<uint32_t>(words.b1), static_cast<uint32_t>(words.b2), words.beta, words.phi});
  if (image.overwrite("calibration_parameters", bytes)) return std::nullopt;
  return Error{
      fmt::format("{}: the program has no place for --parameters; define calibration_parameters as "
                  "firmware/apps/common/parameter_block.h has it, or leave the ELF out",
                  image.path)};
}

}  // namespace capsoc::metrics
