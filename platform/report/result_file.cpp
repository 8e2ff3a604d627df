#include "report/result_file.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include "base/input_file.h"
#include "base/printable.h"

namespace capsoc::report {
namespace {

constexpr const char* advice = "name a file that a command of capsoc wrote by --json";

/// A text that is valid UTF-8: what is not is replaced, as in the result file itself.
std::string valid(const std::string& text) {
  for (const char c : text)
    if (static_cast<unsigned char>(c) >= 0x80)
      return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace), nullptr,
                         false)
          .get<std::string>();
  return text;
}

/// Deeper than any result: what follows the levels one by one could not hold them.
bool is_too_deep(const std::string& text) {
  constexpr int most = 64;
  int depth = 0;
  bool in_text = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_text && c == '\\') {
      ++i;
    } else if (c == '"') {
      in_text = !in_text;
    } else if (!in_text && (c == '[' || c == '{')) {
      if (++depth > most) return true;
    } else if (!in_text && (c == ']' || c == '}')) {
      --depth;
    }
  }
  return false;
}

}  // namespace

Result<ResultFile> read_result(const std::string& path) {
  constexpr uint64_t largest = 256 << 20;
  const auto text = read_input(path, {advice, largest});
  if (!text) return Error{text.error()};
  const std::string name = printable(path, 200);
  if (is_too_deep(text.value()))
    return Error{fmt::format("{}: is nested deeper than any result; {}", name, advice)};
  Json json = Json::parse(text.value(), nullptr, false);
  if (json.is_discarded()) return Error{fmt::format("{}: is not JSON; {}", name, advice)};
  if (command_of(json).empty())
    return Error{fmt::format("{}: is no result of a command that has a report; {}", name, advice)};
  return ResultFile{std::filesystem::path(path).filename().string(), std::move(json)};
}

std::string command_of(const Json& json) {
  if (text_at(json, {"schema"}) == "capsoc-regress-1") return "regress";
  if (text_at(json, {"schema"}) == "capsoc-mutation-1") return "mutation";
  const std::string command = text_at(json, {"command"});
  for (const char* known : {"run", "fit", "reproduce", "accuracy", "bench", "campaign"}) {
    const std::string begin = std::string("capsoc ") + known;
    if (command.compare(0, begin.size(), begin) != 0) continue;
    if (command.size() == begin.size() || command[begin.size()] == ' ') return known;
  }
  return "";
}

const Json* find(const Json& json, Path path) {
  const Json* at = &json;
  for (const char* key : path) {
    if (!at->is_object()) return nullptr;
    const auto found = at->find(key);
    if (found == at->end()) return nullptr;
    at = &*found;
  }
  return at;
}

std::optional<double> number_at(const Json& json, Path path) {
  const Json* at = find(json, path);
  if (at == nullptr || !at->is_number()) return std::nullopt;
  const auto value = at->get<double>();
  return std::isfinite(value) ? std::make_optional(value) : std::nullopt;
}

std::string text_at(const Json& json, Path path) {
  const Json* at = find(json, path);
  return at != nullptr && at->is_string() ? valid(at->get_ref<const std::string&>()) : "";
}

std::string shown_at(const Json& json, Path path) {
  const Json* at = find(json, path);
  if (at == nullptr || at->is_null()) return "-";
  if (at->is_string()) return text_at(json, path);
  if (at->is_number_float() && !std::isfinite(at->get<double>())) return "-";  // null in a file
  if (at->is_structured()) return "...";  // deep ones would be printed recursively
  return at->dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::vector<const Json*> elements_at(const Json& json, Path path) {
  std::vector<const Json*> elements;
  const Json* at = find(json, path);
  if (at != nullptr && at->is_array())
    for (const Json& element : *at) elements.push_back(&element);
  return elements;
}

Curve curve_at(const Json& json, Path path) {
  Curve curve;
  const Json* at = find(json, path);
  if (at == nullptr) return curve;
  const auto x = elements_at(*at, {"x"}), y = elements_at(*at, {"y"});
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
    const auto along = number_at(*x[i], {}), value = number_at(*y[i], {});
    if (along) curve.add(*along, value.value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  return curve;
}

}  // namespace capsoc::report
