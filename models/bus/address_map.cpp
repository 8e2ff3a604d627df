#include "bus/address_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace capsoc::bus {
namespace {

constexpr uint64_t address_space = uint64_t{1} << 32;

std::string describe(const MapEntry& entry) {
  return fmt::format("'{}' [0x{:08x}, 0x{:08x}]", entry.name, entry.base, entry.last());
}

std::string fault_of(const MapEntry& entry) {
  if (entry.name.empty()) return fmt::format("the entry at 0x{:08x} has no name", entry.base);
  if (entry.target.empty()) return fmt::format("'{}' names no target", entry.name);
  if (entry.size == 0) return fmt::format("'{}' has size 0", entry.name);
  if (entry.base >= address_space || entry.size > address_space - entry.base)
    return fmt::format("'{}' reaches past the 32-bit address space", entry.name);
  if (((entry.base | entry.size | entry.offset | entry.wrap) & 3) != 0)
    return describe(entry) + " is not aligned to words";
  if (entry.wrap != 0 && entry.size % entry.wrap != 0)
    return fmt::format("{} is not a whole number of its {} byte windows", describe(entry),
                       entry.wrap);
  return {};
}

void append_line(std::string& text, const std::string& line) {
  if (line.empty()) return;
  if (!text.empty()) text += '\n';
  text += line;
}

}  // namespace

std::string validate(const AddressMap& map) {
  std::string faults;
  std::set<std::string> names;
  std::map<std::string, BusKind> buses;
  std::vector<const MapEntry*> sorted;
  for (const MapEntry& entry : map) {
    const std::string fault = fault_of(entry);
    append_line(faults, fault);
    if (!names.insert(entry.name).second)
      append_line(faults, fmt::format("the name '{}' is used twice", entry.name));
    if (buses.emplace(entry.target, entry.bus).first->second != entry.bus)
      append_line(faults, fmt::format("the target '{}' is on both AHB and APB", entry.target));
    if (fault.empty()) sorted.push_back(&entry);
  }
  std::sort(sorted.begin(), sorted.end(),
            [](const MapEntry* a, const MapEntry* b) { return a->base < b->base; });
  // Compared with the furthest end so far, not with the neighbour: a large range may cover many.
  const MapEntry* furthest = nullptr;
  for (const MapEntry* entry : sorted) {
    if (furthest != nullptr && entry->base <= furthest->last())
      append_line(faults, describe(*furthest) + " overlaps " + describe(*entry));
    if (furthest == nullptr || entry->last() > furthest->last()) furthest = entry;
  }
  return faults;
}

const MapEntry* find_entry(const AddressMap& map, const std::string& name) {
  for (const MapEntry& entry : map)
    if (entry.name == name) return &entry;
  return nullptr;
}

}  // namespace capsoc::bus
