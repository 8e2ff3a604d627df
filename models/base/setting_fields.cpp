#include "base/setting_fields.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "base/number.h"
#include "base/printable.h"
#include "base/result.h"

namespace capsoc {
namespace {

/// The number that a text is, inside its setting's range; else the end of a sentence.
Result<double> number_of(const Setting& about, const std::string& text, bool whole) {
  const auto number = finite_number(text);
  if (!number || (whole && *number != std::floor(*number)))
    return Error{
        fmt::format("cannot be '{}'; give a{} number", printable(text), whole ? " whole" : "")};
  if (*number < about.minimum || *number > about.maximum)
    return Error{
        fmt::format("= {} is out of range; give {:g} to {:g}", text, about.minimum, about.maximum)};
  return *number;
}

}  // namespace

NumberField::NumberField(Settings& owner, Setting declared)
    : SettingField(owner, std::move(declared)) {
  parse(text(), true);
}

std::optional<std::string> NumberField::parse(const std::string& text, bool take) {
  const auto number = number_of(about(), text, false);
  if (!number) return number.error();
  if (take) value_ = number.value();
  return std::nullopt;
}

IntegerField::IntegerField(Settings& owner, Setting declared)
    : SettingField(owner, std::move(declared)) {
  parse(text(), true);
}

std::optional<std::string> IntegerField::parse(const std::string& text, bool take) {
  const auto number = number_of(about(), text, true);
  if (!number) return number.error();
  if (take) value_ = std::llround(number.value());
  return std::nullopt;
}

FlagField::FlagField(Settings& owner, Setting declared) : SettingField(owner, std::move(declared)) {
  parse(text(), true);
}

std::optional<std::string> FlagField::parse(const std::string& text, bool take) {
  if (text != "true" && text != "false")
    return fmt::format("cannot be '{}'; give true or false", printable(text));
  if (take) value_ = text == "true";
  return std::nullopt;
}

std::string no_such_choice(const std::string& text, const std::vector<std::string>& choices) {
  return fmt::format("cannot be '{}'; choose one of {}", printable(text), fmt::join(choices, ", "));
}

}  // namespace capsoc
