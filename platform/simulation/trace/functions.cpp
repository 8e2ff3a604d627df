#include "trace/functions.h"

#include <fmt/format.h>

#include <algorithm>

#include "loader/demangle.h"

namespace capsoc::trace {
namespace {

/// How far after a symbol without a size (assembly) its code may reach, in bytes.
constexpr uint32_t longest_unsized = 0x1000;
/// How many symbols before an address are looked at: nested ones are few.
constexpr int most_nested = 64;

}  // namespace

void Functions::add(const loader::ElfImage& image) {
  symbols_.insert(symbols_.end(), image.symbols.begin(), image.symbols.end());
  std::stable_sort(symbols_.begin(), symbols_.end(), [](const auto& a, const auto& b) {
    return a.address != b.address ? a.address < b.address : a.weak && !b.weak;
  });
  functions_.resize(1);
  for (const loader::Symbol& symbol : symbols_)
    functions_.push_back({symbol.address & ~1U, loader::demangled(symbol.name)});
  known_.clear();
}

uint32_t Functions::look_up(uint32_t address) const {
  const auto behind =
      std::upper_bound(symbols_.begin(), symbols_.end(), address,
                       [](uint32_t a, const loader::Symbol& s) { return a < s.address; });
  uint32_t unsized = unknown;
  int left = most_nested;
  for (auto it = behind; it != symbols_.begin() && left-- > 0;) {
    --it;
    const auto index = static_cast<uint32_t>(it - symbols_.begin()) + 1;
    if (address - it->address < it->size) return index;
    if (it->size == 0 && unsized == unknown && address - it->address < longest_unsized)
      unsized = index;
  }
  return unsized;
}

uint32_t Functions::at(uint32_t address) {
  address &= ~1U;
  const auto [found, added] = known_.try_emplace(address, unknown);
  if (added) found->second = look_up(address);
  return found->second;
}

uint32_t Functions::add_name(const std::string& name) {
  functions_.push_back({0, name});
  return static_cast<uint32_t>(functions_.size() - 1);
}

std::string Functions::place(uint32_t address) {
  const uint32_t index = at(address);
  if (index == unknown) return "";
  const uint32_t offset = (address & ~1U) - functions_[index].address;
  return offset == 0 ? functions_[index].name
                     : fmt::format("{}+{:#x}", functions_[index].name, offset);
}

std::optional<uint32_t> Functions::address_of(const std::string& name) const {
  for (const loader::Symbol& symbol : symbols_)
    if (symbol.name == name) return symbol.address & ~1U;
  for (std::size_t i = 0; i < symbols_.size(); ++i)
    if (functions_[i + 1].name == name) return symbols_[i].address & ~1U;
  return std::nullopt;
}

std::vector<std::string> Functions::names() const {
  std::vector<std::string> names;
  for (const loader::Symbol& symbol : symbols_) names.push_back(symbol.name);
  return names;
}

}  // namespace capsoc::trace
