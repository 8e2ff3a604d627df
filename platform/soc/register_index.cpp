#include "soc/register_index.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/nearest.h"
#include "base/printable.h"

namespace capsoc::soc {
namespace {

/// The element of that name; an Error names the nearest ones.
template <typename T>
Result<const T*> named(const std::vector<T>& all, const std::string& name,
                       const std::string& whose) {
  std::vector<std::string> names;
  for (const T& each : all) {
    if (each.name == name) return &each;
    names.push_back(each.name);
  }
  const std::string asked = printable(name, 80);
  if (names.empty()) return Error{fmt::format("{} has no '{}'; it has no fields", whose, asked)};
  return Error{
      fmt::format("{} has no '{}'; did you mean {}?", whose, asked, nearest_names(asked, names))};
}

}  // namespace

bool RegisterIndex::has_peripheral(const std::string& name) const {
  return std::any_of(peripherals_.begin(), peripherals_.end(),
                     [&](const BoardPeripheral& each) { return each.name == name; });
}

Result<RegisterPlace> RegisterIndex::find(const std::string& name) const {
  const std::size_t first = name.find('.');
  const std::size_t second = first == std::string::npos ? first : name.find('.', first + 1);
  const auto peripheral = named(peripherals_, name.substr(0, first), "the board");
  if (!peripheral) return Error{peripheral.error()};
  if (first == std::string::npos)
    return Error{fmt::format("{} is a device; name one of its registers, {}.{}", name, name,
                             peripheral.value()->registers.empty()
                                 ? "..."
                                 : peripheral.value()->registers.front().name)};
  const std::string reg = name.substr(first + 1, second - first - 1);
  const auto found = named(peripheral.value()->registers, reg, name.substr(0, first));
  if (!found) return Error{found.error()};
  if (second == std::string::npos) return RegisterPlace{found.value(), nullptr};
  const auto field = named(found.value()->fields, name.substr(second + 1), name.substr(0, second));
  if (!field) return Error{field.error()};
  return RegisterPlace{found.value(), field.value()};
}

}  // namespace capsoc::soc
