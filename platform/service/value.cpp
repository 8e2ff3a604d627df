#include "service/value.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>

#include "base/nearest.h"
#include "base/printable.h"

namespace capsoc::service {
namespace {

using source::Variable;

uint64_t word_at(const std::string& bytes, std::size_t at, std::size_t size) {
  uint64_t word = 0;
  for (std::size_t i = std::min<std::size_t>(size, 8); i-- > 0;)
    word = word << 8U | static_cast<uint8_t>(at + i < bytes.size() ? bytes[at + i] : 0);
  return word;
}

void put_word(std::string& bytes, std::size_t at, std::size_t size, uint64_t word) {
  for (std::size_t i = 0; i < size && at + i < bytes.size(); ++i, word >>= 8U)
    bytes[at + i] = static_cast<char>(word & 0xFFU);
}

unsigned bits_of(const Variable& variable) {
  return variable.bits > 0 ? variable.bits : std::min(64U, variable.type->size * 8);
}

int64_t extended(uint64_t word, unsigned bits) {
  if (bits == 0 || bits >= 64) return static_cast<int64_t>(word);
  const uint64_t sign = uint64_t{1} << (bits - 1);
  return static_cast<int64_t>((word ^ sign) - sign);
}

uint64_t mask_of(unsigned bits) {
  return bits >= 64 ? ~uint64_t{0} : (uint64_t{1} << bits) - 1;
}

Json floating(const std::string& bytes, std::size_t at, uint32_t size) {
  double value = 0;
  if (size == 4) {
    float single = 0;
    const auto word = static_cast<uint32_t>(word_at(bytes, at, 4));
    std::memcpy(&single, &word, sizeof single);
    value = single;
  } else {
    const uint64_t word = word_at(bytes, at, 8);
    std::memcpy(&value, &word, sizeof value);
  }
  if (std::isfinite(value)) return value;
  return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}

Json read(const Variable& variable, const std::string& bytes, std::size_t at);

Json elements_of(const source::Type& array, const std::string& bytes, std::size_t at) {
  const source::Type& element = *array.target;
  if (element.kind == source::Type::Kind::character) {
    const std::string text = bytes.substr(at, array.count);
    return text.substr(0, text.find('\0'));
  }
  Json list = Json::array();
  for (uint32_t i = 0; i < array.count; ++i)
    list.push_back(read({"", 0, &element}, bytes, at + std::size_t{i} * element.size));
  return list;
}

Json members(const source::Type& structure, const std::string& bytes, std::size_t at) {
  Json object = Json::object();
  for (const source::Type::Member& member : structure.members)
    object[member.name] =
        read({"", 0, member.type, member.bits, member.bit}, bytes, at + member.offset);
  return object;
}

Json enumerator(const source::Type& type, int64_t value) {
  for (const auto& [name, number] : type.enumerators)
    if (number == value) return name;
  return value;
}

Json read(const Variable& variable, const std::string& bytes, std::size_t at) {
  const source::Type& type = *variable.type;
  const unsigned bits = bits_of(variable);
  const uint64_t word = word_at(bytes, at, variable.size()) >> variable.bit & mask_of(bits);
  switch (type.kind) {
    case source::Type::Kind::structure:
      return members(type, bytes, at);
    case source::Type::Kind::array:
      return elements_of(type, bytes, at);
    case source::Type::Kind::floating:
      return floating(bytes, at, type.size);
    case source::Type::Kind::boolean:
      return word != 0;
    case source::Type::Kind::enumeration:
      return enumerator(type, type.is_signed ? extended(word, bits) : static_cast<int64_t>(word));
    case source::Type::Kind::integer:
    case source::Type::Kind::character:
      if (type.is_signed) return extended(word, bits);
      return word;
    case source::Type::Kind::pointer:
      return word;
    case source::Type::Kind::opaque:
      break;
  }
  Json list = Json::array();
  for (uint32_t i = 0; i < type.size; ++i) list.push_back(word_at(bytes, at + i, 1));
  return list;
}

std::optional<Error> write(const Variable& variable, const Json& value, std::string& bytes,
                           std::size_t at);

/// True if the value is an integer that fits in `bits` bits.
bool fits_in(const Json& value, unsigned bits, bool is_signed) {
  if (!value.is_number_integer()) return false;
  const bool is_negative = !value.is_number_unsigned() && value.get<int64_t>() < 0;
  if (!is_signed) return !is_negative && (value.get<uint64_t>() & ~mask_of(bits)) == 0;
  if (is_negative)
    return extended(value.get<uint64_t>() & mask_of(bits), bits) == value.get<int64_t>();
  return (value.get<uint64_t>() & ~mask_of(bits - 1)) == 0;
}

Error wrong(const Variable& variable, const char* wanted) {
  return Error{fmt::format("{} is {}: give {}", variable.name, variable.type->name, wanted)};
}

std::optional<Error> write_integer(const Variable& variable, const Json& value, std::string& bytes,
                                   std::size_t at) {
  const unsigned bits = bits_of(variable);
  const bool fits = fits_in(value, bits, variable.type->is_signed);
  if (!fits) return wrong(variable, fmt::format("a whole number of {} bits", bits).c_str());
  const std::size_t size = variable.size();
  const uint64_t mask = mask_of(bits) << variable.bit;
  const uint64_t number = value.is_number_unsigned() ? value.get<uint64_t>()
                                                     : static_cast<uint64_t>(value.get<int64_t>());
  put_word(bytes, at, size, (word_at(bytes, at, size) & ~mask) | (number << variable.bit & mask));
  return std::nullopt;
}

std::optional<Error> write_enumerator(const Variable& variable, const Json& value,
                                      std::string& bytes, std::size_t at) {
  if (!value.is_string()) return write_integer(variable, value, bytes, at);
  std::vector<std::string> names;
  for (const auto& [name, number] : variable.type->enumerators) {
    if (name == value.get_ref<const std::string&>())
      return write_integer(variable, Json(number), bytes, at);
    names.push_back(name);
  }
  return Error{fmt::format("{} has no value '{}'; did you mean {}?", variable.type->name,
                           printable(value.get<std::string>(), 80),
                           nearest_names(printable(value.get<std::string>(), 80), names))};
}

std::optional<Error> write_floating(const Variable& variable, const Json& value, std::string& bytes,
                                    std::size_t at) {
  if (!value.is_number()) return wrong(variable, "a number");
  if (variable.type->size == 4) {
    const auto single = value.get<float>();
    uint32_t word = 0;
    std::memcpy(&word, &single, sizeof word);
    put_word(bytes, at, 4, word);
  } else {
    const auto number = value.get<double>();
    uint64_t word = 0;
    std::memcpy(&word, &number, sizeof word);
    put_word(bytes, at, 8, word);
  }
  return std::nullopt;
}

std::optional<Error> write_members(const Variable& variable, const Json& value, std::string& bytes,
                                   std::size_t at) {
  if (!value.is_object()) return wrong(variable, "an object with the members to be changed");
  for (const auto& [name, part] : value.items()) {
    std::vector<std::string> names;
    const source::Type::Member* found = nullptr;
    for (const source::Type::Member& member : variable.type->members) {
      names.push_back(member.name);
      if (member.name == name) found = &member;
    }
    if (found == nullptr)
      return Error{fmt::format("{} has no member '{}'; did you mean {}?", variable.name,
                               printable(name, 80), nearest_names(printable(name, 80), names))};
    const Variable member{variable.name + "." + name, 0, found->type, found->bits, found->bit};
    if (auto error = write(member, part, bytes, at + found->offset)) return error;
  }
  return std::nullopt;
}

std::optional<Error> write_elements(const Variable& variable, const Json& value, std::string& bytes,
                                    std::size_t at) {
  const source::Type& type = *variable.type;
  if (value.is_string() && type.target->kind == source::Type::Kind::character) {
    const auto& text = value.get_ref<const std::string&>();
    if (text.size() > type.count) return wrong(variable, "a text that fits");
    for (uint32_t i = 0; i < type.count && at + i < bytes.size(); ++i)
      bytes[at + i] = i < text.size() ? text[i] : '\0';
    return std::nullopt;
  }
  if (!value.is_array() || value.size() > type.count) return wrong(variable, "a list that fits");
  for (std::size_t i = 0; i < value.size(); ++i) {
    const Variable element{fmt::format("{}[{}]", variable.name, i), 0, type.target};
    if (auto error = write(element, value[i], bytes, at + i * type.target->size)) return error;
  }
  return std::nullopt;
}

std::optional<Error> write(const Variable& variable, const Json& value, std::string& bytes,
                           std::size_t at) {
  switch (variable.type->kind) {
    case source::Type::Kind::structure:
      return write_members(variable, value, bytes, at);
    case source::Type::Kind::array:
      return write_elements(variable, value, bytes, at);
    case source::Type::Kind::floating:
      return write_floating(variable, value, bytes, at);
    case source::Type::Kind::enumeration:
      return write_enumerator(variable, value, bytes, at);
    case source::Type::Kind::boolean:
      if (value.is_boolean())
        return write_integer(variable, Json(value.get<bool>() ? 1U : 0U), bytes, at);
      return wrong(variable, "true or false");
    case source::Type::Kind::integer:
    case source::Type::Kind::character:
    case source::Type::Kind::pointer:
      return write_integer(variable, value, bytes, at);
    case source::Type::Kind::opaque:
      break;
  }
  return wrong(variable, "bytes to its address with memory.write");
}

}  // namespace

Json value_of(const Variable& variable, const std::string& bytes) {
  return read(variable, bytes, 0);
}

Result<std::string> bytes_of(const Variable& variable, const Json& value, std::string old) {
  if (auto error = write(variable, value, old, 0)) return *error;
  return old;
}

}  // namespace capsoc::service
