#include "soc/board_map.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "capsoc_registers.h"

namespace capsoc::soc {
namespace {

using bus::AddressMap, bus::BusKind, bus::InterruptWire, bus::MapEntry, bus::TargetKind;

constexpr uint64_t slot = 4 * kib;  // what one APB or GPIO device occupies

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

MapEntry device_at(std::string name, uint64_t base, std::vector<InterruptWire> interrupts = {}) {
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
  map.push_back(device_at("timer0", 0x40000000, {{"interrupt", 8}}));
  map.push_back(device_at("timer1", 0x40001000, {{"interrupt", 9}}));
  map.push_back(device_at("dual_timer", 0x40002000, {{"interrupt", 10}}));
  map.push_back(missing("reserved_apb_3", 0x40003000));
  map.push_back(device_at("uart0", 0x40004000, {{"rx", 0}, {"tx", 1}, {"overrun", 12}}));
  map.push_back(device_at("uart1", 0x40005000, {{"rx", 2}, {"tx", 3}, {"overrun", 12}}));
  map.push_back(device_at("uart2", 0x40006000, {{"rx", 4}, {"tx", 5}, {"overrun", 12}}));
  map.push_back(device_at("uart3", 0x40007000, {{"rx", 18}, {"tx", 19}, {"overrun", 12}}));
  map.push_back(device_at("watchdog", 0x40008000, {{"interrupt", bus::nmi_line}}));
  map.push_back(device_at("uart4", 0x40009000, {{"rx", 20}, {"tx", 21}, {"overrun", 12}}));
  map.push_back(hole("reserved_apb_a", 0x4000a000, 2 * slot, BusKind::apb));
  map.push_back(device_at("coprocessor", registers::coprocessor::base_address,
                          {{"interrupt", registers::coprocessor::interrupt}}));
  map.push_back(device_at("adc_front_end", registers::adc::base_address,
                          {{"interrupt", registers::adc::interrupt}}));
  map.push_back(device_at("clock_controller", registers::clockctrl::base_address));
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
  map.push_back(device_at("fpgaio", 0x40028000));
  map.push_back(missing("i2c2", 0x40029000));
  map.push_back(missing("i2c3", 0x4002a000));
  map.push_back(hole("reserved_fpga", 0x4002b000, 4 * slot, BusKind::apb));
  map.push_back(device_at("scc", 0x4002f000));
  map.push_back(hole("reserved_4", 0x40030000, 0x001d0000));
  map.push_back(hole("ethernet", 0x40200000, 1 * mib));
  map.back().interrupts = {{"interrupt", 13}};
  map.push_back(hole("vga", 0x41000000, 2 * mib));
}

}  // namespace

AddressMap board_map(const MemoryWaits& waits) {
  AddressMap map;
  add_memories(map, waits);
  add_cmsdk_apb_devices(map);
  add_gpio(map);
  add_board_devices(map);
  return map;
}

}  // namespace capsoc::soc
