#include "service/verb.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/nearest.h"
#include "base/printable.h"

namespace capsoc::service {
namespace {

constexpr uint64_t exact = uint64_t{1} << 53U;  // JSON numbers of other languages
constexpr std::size_t longest_list = std::size_t{1} << 20;

/// The element types of arrays, as NumPy names them.
struct Element {
  const char* name;
  std::size_t size;
  double (*value)(const char* bytes);
};

template <typename T>
double element(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

constexpr Element elements[] = {
    {"<f8", 8, element<double>},   {"<f4", 4, element<float>},    {"<i4", 4, element<int32_t>},
    {"<u4", 4, element<uint32_t>}, {"<i2", 2, element<int16_t>},  {"<u2", 2, element<uint16_t>},
    {"|u1", 1, element<uint8_t>},  {"<u1", 1, element<uint8_t>},  {"|i1", 1, element<int8_t>},
    {"<i8", 8, element<int64_t>},  {"<u8", 8, element<uint64_t>},
};

const Element* element_of(const Json& value) {
  const auto type = value.find("type");
  if (type == value.end() || !type->is_string()) return nullptr;
  for (const Element& each : elements)
    if (type->get_ref<const std::string&>() == each.name) return &each;
  return nullptr;
}

bool is_below(const Json& value, uint64_t end) {
  if (!value.is_number_integer() || (!value.is_number_unsigned() && value.get<int64_t>() < 0))
    return false;
  return value.get<uint64_t>() < end;
}

/// The frame that an array refers to, whole elements of its type; null if it is none.
const std::string* frame_of(const Json& value, const Frames& frames) {
  if (!value.is_object()) return nullptr;
  const Element* const element = element_of(value);
  const auto number = value.find("frame");
  if (element == nullptr || number == value.end() || !is_below(*number, frames.size()))
    return nullptr;
  const std::string& frame = frames[number->get<std::size_t>()];
  return frame.size() % element->size == 0 ? &frame : nullptr;
}

bool is_list_of_numbers(const Json& value) {
  return value.is_array() && value.size() <= longest_list &&
         std::all_of(value.begin(), value.end(), [](const Json& each) { return each.is_number(); });
}

bool is_list_of_texts(const Json& value) {
  return value.is_array() &&
         std::all_of(value.begin(), value.end(), [](const Json& each) { return each.is_string(); });
}

bool is_of(Type type, const Json& value, const Frames& frames) {
  switch (type) {
    case Type::integer:
      return is_below(value, exact + 1);
    case Type::number:
      return value.is_number() && std::isfinite(value.get<double>());
    case Type::text:
      return value.is_string();
    case Type::boolean:
      return value.is_boolean();
    case Type::object:
      return value.is_object();
    case Type::list:
      return is_list_of_texts(value);
    case Type::array:
      return is_list_of_numbers(value) || frame_of(value, frames) != nullptr;
    case Type::bytes:
      return value.is_string() || is_list_of_numbers(value) || frame_of(value, frames) != nullptr;
    case Type::address:
      return value.is_string() || is_below(value, uint64_t{1} << 32U);
    case Type::any:
      return true;
  }
  return false;
}

const char* words_for(Type type) {
  switch (type) {
    case Type::integer:
      return "a whole number from 0 to 2^53";
    case Type::number:
      return "a number";
    case Type::text:
      return "a text";
    case Type::boolean:
      return "true or false";
    case Type::object:
      return "an object";
    case Type::list:
      return "a list of texts";
    case Type::array:
      return R"(a list of numbers, or {"frame": n, "type": "<f8"} with that frame)";
    case Type::bytes:
      return R"(a text, a list of bytes, or {"frame": n, "type": "|u1"} with that frame)";
    case Type::address:
      return "a number below 2^32 or the name of a symbol";
    case Type::any:
      return "a value";
  }
  return "";
}

}  // namespace

const char* name_of(Type type) {
  static constexpr const char* names[] = {"integer", "number", "text",  "boolean", "object",
                                          "list",    "array",  "bytes", "address", "any"};
  return names[static_cast<std::size_t>(type)];
}

void Answer::add_array(Json& object, const std::string& name, const std::vector<double>& values) {
  object[name] = {{"frame", frames.size()}, {"type", "<f8"}, {"shape", {values.size()}}};
  frames.emplace_back(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
}

void Answer::add_bytes(Json& object, const std::string& name, std::string bytes) {
  object[name] = {{"frame", frames.size()}, {"type", "|u1"}, {"shape", {bytes.size()}}};
  frames.push_back(std::move(bytes));
}

std::vector<double> numbers_in(const Json& value, const Frames& frames) {
  std::vector<double> values;
  if (value.is_array()) {
    for (const Json& each : value) values.push_back(each.get<double>());
    return values;
  }
  const Element& type = *element_of(value);
  const std::string& frame = *frame_of(value, frames);
  values.reserve(frame.size() / type.size);
  for (std::size_t at = 0; at < frame.size(); at += type.size)
    values.push_back(type.value(frame.data() + at));
  return values;
}

std::string bytes_in(const Json& value, const Frames& frames) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_object() && element_of(value)->size == 1) return *frame_of(value, frames);
  std::string bytes;
  for (const double each : numbers_in(value, frames))
    bytes += static_cast<char>(static_cast<int>(each) & 0xFF);
  return bytes;
}

Answer refuse(std::string sentence, Code code) {
  Answer answer;
  answer.code = code;
  answer.sentence = std::move(sentence);
  return answer;
}

std::string to_bytes(Json body, Answer answer) {
  Message message{std::move(body), std::move(answer.frames)};
  if (answer.ok())
    message.body["result"] = std::move(answer.result);
  else
    message.body["error"] = error_of(answer.code, answer.sentence);
  return to_bytes(message);
}

std::string to_client(const Json& id, Answer answer) {
  return to_bytes(Json{{"jsonrpc", "2.0"}, {"id", id}}, std::move(answer));
}

std::string Call::complaint_about(const Parameter& parameter) const {
  const auto found = parameters_.find(parameter.name);
  if (found == parameters_.end()) {
    if (!parameter.required) return "";
    return fmt::format("{}: the parameter '{}' is missing: {}", declaration_.method, parameter.name,
                       words_for(parameter.type));
  }
  if (is_of(parameter.type, *found, frames_)) return "";
  return fmt::format("{}: the parameter '{}' has to be {}", declaration_.method, parameter.name,
                     words_for(parameter.type));
}

std::string Call::complaint() const {
  const auto& all = declaration_.parameters;
  for (const Parameter& parameter : all)
    if (std::string complaint = complaint_about(parameter); !complaint.empty()) return complaint;
  for (const auto& [given, value] : parameters_.items()) {
    const std::string& name = given;
    const auto is_it = [&name](const Parameter& each) { return each.name == name; };
    if (name == "simulation" || std::any_of(all.begin(), all.end(), is_it)) continue;
    if (all.empty())
      return fmt::format("{}: there is no parameter '{}'; it takes none", declaration_.method,
                         printable(name, 80));
    std::vector<std::string> known;
    known.reserve(all.size());
    for (const Parameter& parameter : all) known.push_back(parameter.name);
    return fmt::format("{}: there is no parameter '{}'; did you mean {}?", declaration_.method,
                       printable(name, 80), nearest_names(printable(name, 80), known));
  }
  return "";
}

std::vector<std::string> Call::texts(const char* name) const {
  std::vector<std::string> texts;
  for (const Json& each : parameters_.at(name)) texts.push_back(each.get<std::string>());
  return texts;
}

Json schema_of(const Declaration& declaration, bool of_simulation) {
  Json parameters = Json::array(), result = Json::array();
  if (of_simulation)
    parameters.push_back(
        {{"name", "simulation"}, {"type", "integer"}, {"required", true}, {"text", "its number"}});
  for (const Parameter& each : declaration.parameters)
    parameters.push_back({{"name", each.name},
                          {"type", name_of(each.type)},
                          {"required", each.required},
                          {"text", each.text}});
  for (const Member& each : declaration.result)
    result.push_back({{"name", each.name}, {"type", each.type}, {"text", each.text}});
  return {{"name", declaration.method},
          {"text", declaration.text},
          {"simulation", of_simulation},
          {"params", std::move(parameters)},
          {"result", std::move(result)}};
}

}  // namespace capsoc::service
