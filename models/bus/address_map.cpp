#include "bus/address_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "capsoc_registers.h"

namespace capsoc::bus {
namespace {

constexpr uint64_t address_space = uint64_t{1} << 32;
constexpr uint64_t kib = 1024;
constexpr uint64_t mib = 1024 * kib;
constexpr uint64_t slot = 4 * kib;  // what one APB or GPIO device occupies

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

MapEntry memory_at(std::string name, std::string target, uint64_t base, uint64_t size,
                   unsigned wait_states) {
  MapEntry entry;
  entry.name = std::move(name);
  entry.target = std::move(target);
  entry.base = base;
  entry.size = size;
  entry.wait_states = wait_states;
  entry.kind = TargetKind::memory;
  return entry;
}

MapEntry slot_at(std::string name, uint64_t base, TargetKind kind, BusKind bus,
                 std::vector<InterruptWire> interrupts = {}) {
  MapEntry entry;
  entry.name = entry.target = std::move(name);
  entry.base = base;
  entry.size = slot;
  entry.kind = kind;
  entry.bus = bus;
  entry.interrupts = std::move(interrupts);
  return entry;
}

MapEntry device(std::string name, uint64_t base, std::vector<InterruptWire> interrupts = {}) {
  return slot_at(std::move(name), base, TargetKind::device, BusKind::apb, std::move(interrupts));
}

MapEntry missing(std::string name, uint64_t base, std::vector<InterruptWire> interrupts = {}) {
  return slot_at(std::move(name), base, TargetKind::unimplemented, BusKind::apb,
                 std::move(interrupts));
}

MapEntry hole(std::string name, uint64_t base, uint64_t size, BusKind bus = BusKind::ahb) {
  MapEntry entry = slot_at(std::move(name), base, TargetKind::unimplemented, bus);
  entry.size = size;
  return entry;
}

void add_memories(AddressMap& map, const MemoryWaits& waits) {
  map.push_back(memory_at("code_sram", "code_sram", 0x00000000, 4 * mib, waits.code_sram));
  map.push_back(memory_at("code_sram_alias", "code_sram", 0x00400000, 4 * mib, waits.code_sram));
  map.push_back(hole("reserved_1", 0x00800000, 8 * mib));
  map.push_back(memory_at("block_ram", "block_ram", 0x01000000, 64 * kib, waits.block_ram));
  map.back().wrap = 16 * kib;
  map.push_back(hole("reserved_2", 0x01010000, 0x1eff0000));
  map.push_back(memory_at("data_sram", "data_sram", 0x20000000, 4 * mib, waits.data_sram));
  map.push_back(memory_at("data_sram_alias", "data_sram", 0x20400000, 4 * mib, waits.data_sram));
  map.push_back(hole("reserved_3", 0x20800000, 8 * mib));
  map.push_back(memory_at("psram", "psram", 0x21000000, 16 * mib, waits.psram));
}

void add_cmsdk_apb_devices(AddressMap& map) {
  map.push_back(device("timer0", 0x40000000, {{"interrupt", 8}}));
  map.push_back(device("timer1", 0x40001000, {{"interrupt", 9}}));
  map.push_back(device("dual_timer", 0x40002000, {{"interrupt", 10}}));
  map.push_back(missing("reserved_apb_3", 0x40003000));
  map.push_back(device("uart0", 0x40004000, {{"rx", 0}, {"tx", 1}, {"overrun", 12}}));
  map.push_back(device("uart1", 0x40005000, {{"rx", 2}, {"tx", 3}, {"overrun", 12}}));
  map.push_back(device("uart2", 0x40006000, {{"rx", 4}, {"tx", 5}, {"overrun", 12}}));
  map.push_back(device("uart3", 0x40007000, {{"rx", 18}, {"tx", 19}, {"overrun", 12}}));
  map.push_back(device("watchdog", 0x40008000, {{"interrupt", nmi_line}}));
  map.push_back(device("uart4", 0x40009000, {{"rx", 20}, {"tx", 21}, {"overrun", 12}}));
  map.push_back(hole("reserved_apb_a", 0x4000a000, 2 * slot, BusKind::apb));
  map.push_back(device("coprocessor", registers::coprocessor::base_address,
                       {{"interrupt", registers::coprocessor::interrupt}}));
  map.push_back(device("adc_front_end", registers::adc::base_address,
                       {{"interrupt", registers::adc::interrupt}}));
  map.push_back(device("clock_controller", registers::clockctrl::base_address));
  map.push_back(missing("reserved_apb_f", 0x4000f000));
}

void add_gpio(AddressMap& map) {
  constexpr auto ahb = BusKind::ahb;
  constexpr auto absent = TargetKind::unimplemented;
  map.push_back(slot_at("gpio0", 0x40010000, TargetKind::device, ahb, {{"combined", 6}}));
  map.push_back(slot_at("gpio1", 0x40011000, TargetKind::device, ahb, {{"combined", 7}}));
  map.push_back(slot_at("gpio2", 0x40012000, TargetKind::device, ahb, {{"combined", 16}}));
  map.push_back(slot_at("gpio3", 0x40013000, TargetKind::device, ahb, {{"combined", 17}}));
  map.push_back(hole("reserved_ahb", 0x40014000, 11 * slot));
  map.push_back(slot_at("system_controller", 0x4001f000, absent, ahb));
}

void add_board_devices(AddressMap& map) {
  // The PL022 cells share lines in pairs: external connector and LCD, shield 0 and shield 1.
  map.push_back(missing("spi0", 0x40020000, {{"interrupt", 11}}));
  map.push_back(missing("spi1", 0x40021000, {{"interrupt", 11}}));
  map.push_back(missing("i2c0", 0x40022000));
  map.push_back(missing("i2c1", 0x40023000));
  map.push_back(missing("i2s", 0x40024000, {{"interrupt", 14}}));
  map.push_back(missing("spi2", 0x40025000, {{"interrupt", 22}}));
  map.push_back(missing("spi3", 0x40026000, {{"interrupt", 24}}));
  map.push_back(missing("spi4", 0x40027000, {{"interrupt", 24}}));
  map.push_back(device("fpgaio", 0x40028000));
  map.push_back(missing("i2c2", 0x40029000));
  map.push_back(missing("i2c3", 0x4002a000));
  map.push_back(hole("reserved_fpga", 0x4002b000, 4 * slot, BusKind::apb));
  map.push_back(device("scc", 0x4002f000));
  map.push_back(hole("reserved_4", 0x40030000, 0x001d0000));
  map.push_back(hole("ethernet", 0x40200000, 1 * mib));
  map.back().interrupts = {{"interrupt", 13}};
  map.push_back(hole("vga", 0x41000000, 2 * mib));
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

AddressMap soc_address_map(const MemoryWaits& waits) {
  AddressMap map;
  add_memories(map, waits);
  add_cmsdk_apb_devices(map);
  add_gpio(map);
  add_board_devices(map);
  return map;
}

const MapEntry* find_entry(const AddressMap& map, const std::string& name) {
  for (const MapEntry& entry : map)
    if (entry.name == name) return &entry;
  return nullptr;
}

}  // namespace capsoc::bus
