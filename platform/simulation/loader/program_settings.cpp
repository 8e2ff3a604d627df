#include "loader/program_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>

#include "base/number.h"
#include "base/printable.h"

namespace capsoc::loader {
namespace {

// firmware/common/program_settings.h
constexpr const char* object_name = "program_settings";
constexpr uint32_t magic = 0x31544553;
constexpr std::size_t header_size = 8, description_size = 160;
constexpr uint64_t most_settings = 1000;  // more than any command line has
constexpr std::size_t name_size = 32, unit_size = 16, help_size = 80;
constexpr std::size_t unit_at = 32, help_at = 48, offset_at = 128, size_at = 132, kind_at = 134,
                      per_unit_at = 136, least_at = 144, greatest_at = 152;

/// Little-endian; the caller has checked that it lies inside.
uint64_t load(const std::vector<uint8_t>& bytes, std::size_t at, std::size_t size) {
  uint64_t value = 0;
  for (std::size_t i = size; i > 0; --i) value = value << 8U | bytes[at + i - 1];
  return value;
}

void store(std::vector<uint8_t>& bytes, std::size_t at, std::size_t size, uint64_t value) {
  for (std::size_t i = 0; i < size; ++i) bytes[at + i] = static_cast<uint8_t>(value >> (8 * i));
}

/// Characters up to a 0; nothing without one, or with what no terminal prints.
std::optional<std::string> text_at(const std::vector<uint8_t>& bytes, std::size_t at,
                                   std::size_t size) {
  std::string text;
  for (std::size_t i = 0; i < size; ++i) {
    const uint8_t c = bytes[at + i];
    if (c == 0) return text;
    if (c < 0x20 || c > 0x7E) return std::nullopt;
    text += static_cast<char>(c);
  }
  return std::nullopt;
}

bool is_name(const std::string& text) {
  const auto is_letter = [](char c) { return c >= 'a' && c <= 'z'; };
  return !text.empty() && is_letter(text[0]) && std::all_of(text.begin(), text.end(), [&](char c) {
    return is_letter(c) || (c >= '0' && c <= '9') || c == '_';
  });
}

/// The range of words of a type.
std::pair<int64_t, int64_t> limits(const ProgramSetting& setting) {
  const unsigned bits = 8 * setting.size;
  if (setting.kind == ProgramSetting::Kind::signed_number)
    return {bits == 64 ? INT64_MIN : -(int64_t{1} << (bits - 1)),
            bits == 64 ? INT64_MAX : (int64_t{1} << (bits - 1)) - 1};
  return {0, bits == 64 ? INT64_MAX : (int64_t{1} << bits) - 1};
}

/// What is wrong with a description, or null.
const char* fault(const ProgramSetting& setting, std::size_t values_at, std::size_t object_size) {
  if (setting.offset < values_at || setting.offset > object_size ||
      setting.size > object_size - setting.offset)
    return "its value lies outside the object's values";
  if (setting.kind == ProgramSetting::Kind::text)
    return setting.size == 0 ? "its text has no room" : nullptr;
  if (setting.size != 1 && setting.size != 2 && setting.size != 4 && setting.size != 8)
    return "its value has neither 1, 2, 4 nor 8 bytes";
  if (setting.per_unit < 1) return "its unit is not positive";
  const auto [least, greatest] = limits(setting);
  if (setting.least < least || setting.greatest > greatest || setting.least > setting.greatest)
    return "its range does not fit its type";
  return nullptr;
}

/// A whole number, decimal or 0x.
std::optional<int64_t> whole_number(const std::string& text) {
  const bool hexadecimal = text.rfind("0x", 0) == 0;
  const char* begin = text.data() + (hexadecimal ? 2 : 0);
  const char* end = text.data() + text.size();
  int64_t value = 0;
  const auto [last, status] = std::from_chars(begin, end, value, hexadecimal ? 16 : 10);
  if (status != std::errc() || last != end || (hexadecimal && value < 0)) return std::nullopt;
  return value;
}

/// The nearest word, if 64 bits hold it.
std::optional<int64_t> to_word(double value, int64_t per_unit) {
  const double word = std::round(value * static_cast<double>(per_unit));
  if (!(std::fabs(word) < 0x1p63)) return std::nullopt;
  return static_cast<int64_t>(word);
}

}  // namespace

Result<ProgramSettings> ProgramSettings::read(const ElfImage& image) {
  ProgramSettings settings;
  auto bytes = image.contents(object_name);
  // Another program may use the name for something else.
  if (!bytes || bytes->size() < header_size || load(*bytes, 0, 4) != magic) return settings;
  const auto damaged = [&](const std::string& what) {
    return Error{
        fmt::format("{}: its program_settings are damaged: {}; rebuild it with "
                    "program_settings.h",
                    image.path, what)};
  };
  const uint64_t count = load(*bytes, 4, 4);
  if (count > (bytes->size() - header_size) / description_size)
    return damaged("they end after their object");
  if (count > most_settings)
    return damaged(fmt::format("{} are more than {}", count, most_settings));
  const std::size_t values_at = header_size + count * description_size;
  settings.bytes_ = std::move(*bytes);
  const std::vector<uint8_t>& object = settings.bytes_;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = header_size + i * description_size;
    const auto name = text_at(object, at, name_size),
               unit = text_at(object, at + unit_at, unit_size),
               help = text_at(object, at + help_at, help_size);
    if (!name || !unit || !help || !is_name(*name))
      return damaged(fmt::format("setting {} has no legal name, unit or meaning", i));
    ProgramSetting setting{*name, *unit, *help};
    const uint64_t kind = load(object, at + kind_at, 1);
    if (kind > 2) return damaged(fmt::format("{} has an unknown kind", *name));
    setting.kind = static_cast<ProgramSetting::Kind>(kind);
    setting.offset = static_cast<uint32_t>(load(object, at + offset_at, 4));
    setting.size = static_cast<uint32_t>(load(object, at + size_at, 2));
    setting.per_unit = static_cast<int64_t>(load(object, at + per_unit_at, 8));
    setting.least = static_cast<int64_t>(load(object, at + least_at, 8));
    setting.greatest = static_cast<int64_t>(load(object, at + greatest_at, 8));
    if (const char* what = fault(setting, values_at, object.size()))
      return damaged(fmt::format("{}: {}", *name, what));
    if (settings.find(*name) != nullptr) return damaged(fmt::format("{} is there twice", *name));
    settings.all_.push_back(std::move(setting));
  }
  return settings;
}

const ProgramSetting* ProgramSettings::find(const std::string& name) const {
  for (const ProgramSetting& setting : all_)
    if (setting.name == name) return &setting;
  return nullptr;
}

int64_t ProgramSettings::word(const ProgramSetting& setting) const {
  const uint64_t raw = load(bytes_, setting.offset, setting.size);
  if (setting.kind == ProgramSetting::Kind::unsigned_number) return static_cast<int64_t>(raw);
  switch (setting.size) {
    case 1:
      return static_cast<int8_t>(raw);
    case 2:
      return static_cast<int16_t>(raw);
    case 4:
      return static_cast<int32_t>(raw);
    default:
      return static_cast<int64_t>(raw);
  }
}

std::string ProgramSettings::number(const ProgramSetting& setting, int64_t word) const {
  if (setting.per_unit == 1) return fmt::format("{}", word);
  const double value = static_cast<double>(word) / static_cast<double>(setting.per_unit);
  for (int digits = 1; digits < 17; ++digits) {
    const auto shorter = finite_number(fmt::format("{:.{}g}", value, digits));
    if (shorter && to_word(*shorter, setting.per_unit) == word) return fmt::format("{}", *shorter);
  }
  return fmt::format("{}", value);
}

std::string ProgramSettings::value(const ProgramSetting& setting) const {
  if (setting.kind != ProgramSetting::Kind::text) return number(setting, word(setting));
  const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(setting.offset);
  return {begin, std::find(begin, begin + static_cast<std::ptrdiff_t>(setting.size), 0)};
}

std::string ProgramSettings::range(const ProgramSetting& setting) const {
  if (setting.kind == ProgramSetting::Kind::text)
    return fmt::format("at most {} bytes", setting.size - 1);
  return fmt::format("{} .. {}", number(setting, setting.least), number(setting, setting.greatest));
}

std::optional<Error> ProgramSettings::set(const ProgramSetting& setting, const std::string& text,
                                          const std::string& origin) {
  const auto refuse = [&](const std::string& what) {
    return Error{fmt::format("{}: {}", origin, what)};
  };
  if (setting.kind == ProgramSetting::Kind::text) {
    if (text.size() >= setting.size || text.find('\0') != std::string::npos)
      return refuse(fmt::format("{} has {} bytes and is too long; give {}", setting.name,
                                text.size(), range(setting)));
    for (std::size_t i = 0; i < setting.size; ++i)
      bytes_[setting.offset + i] = i < text.size() ? static_cast<uint8_t>(text[i]) : 0;
    return std::nullopt;
  }
  const auto whole = setting.per_unit == 1 ? whole_number(text) : std::nullopt;
  const auto real = finite_number(text);
  const bool fraction = setting.per_unit == 1 && real && *real != std::floor(*real);
  if ((!whole && !real) || fraction)
    return refuse(fmt::format("{} cannot be '{}'; give a{} number{}{}", setting.name,
                              printable(text), setting.per_unit == 1 ? " whole" : "",
                              setting.unit.empty() ? "" : " in ", setting.unit));
  const auto word = whole ? whole : to_word(*real, setting.per_unit);
  if (!word || *word < setting.least || *word > setting.greatest)
    return refuse(fmt::format("{} = {} is out of range; give {}{}{}", setting.name, printable(text),
                              range(setting), setting.unit.empty() ? "" : " ", setting.unit));
  if (*word == 0 && real && *real != 0)
    return refuse(fmt::format("{} = {} is too small and would become 0; its resolution is {:.3g}",
                              setting.name, printable(text),
                              1 / static_cast<double>(setting.per_unit)));
  store(bytes_, setting.offset, setting.size, static_cast<uint64_t>(*word));
  return std::nullopt;
}

void ProgramSettings::write(ElfImage& image) const {
  if (!bytes_.empty()) image.overwrite(object_name, bytes_);
}

}  // namespace capsoc::loader
