#include "inject/places.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/nearest.h"
#include "base/number.h"
#include "base/printable.h"
#include "debug/soc_target.h"
#include "inject/system_fields.h"
#include "soc/board_map.h"

namespace capsoc::inject {
namespace {

constexpr const char* processor = "cpu.";
constexpr const char* memory = "mem:";
constexpr const char* forms =
    "write cpu.REGISTER, mem:ADDRESS, mem:VARIABLE[+BYTES], DEVICE.REGISTER[.FIELD], "
    "coprocessor.STATE, model.STATE, rtl.FLIP_FLOP, sin or cos";

/// What exists of a register that a debugger shows in a byte.
unsigned bits_of(const debug::Register& reg, const armv7m::Profile& profile) {
  const std::string name = reg.name;
  if (name == "primask" || name == "faultmask") return 1;
  if (name == "control") return static_cast<unsigned>(__builtin_popcount(profile.control_bits()));
  return reg.bits;
}

class CoreRegister final : public Place {
 public:
  CoreRegister(soc::Soc& soc, unsigned index) : target_(soc), index_(index) {}

  std::optional<Change> change(const To& to) override {
    const uint32_t before = target_.read_register(index_);
    const auto wanted = static_cast<uint32_t>(to(before));
    if (wanted != before) target_.write_register(index_, wanted);
    return Change{before, target_.read_register(index_)};
  }

 private:
  debug::SocTarget target_;
  unsigned index_;
};

class SystemBits final : public Place {
 public:
  SystemBits(armv7m::Core& core, SystemField field) : core_(core), field_(std::move(field)) {}

  std::optional<Change> change(const To& to) override {
    const uint32_t before = read_field(core_, field_);
    const auto wanted = static_cast<uint32_t>(to(before));
    if (wanted == before) return Change{before, before};
    write_field(core_, field_, wanted);
    return Change{before, read_field(core_, field_)};
  }

 private:
  armv7m::Core& core_;
  SystemField field_;
};

class MemoryByte final : public Place {
 public:
  MemoryByte(soc::Soc& soc, uint32_t address) : soc_(soc), address_(address) {}

  std::optional<Change> change(const To& to) override {
    uint8_t before = 0;
    soc_.read_memory(address_, &before, 1);
    const auto after = static_cast<uint8_t>(to(before));
    if (after != before) soc_.write_memory(address_, &after, 1);
    return Change{before, after};
  }

 private:
  soc::Soc& soc_;
  uint32_t address_;
};

/// The stored word of a register. Its device plans its events again from it.
class DeviceRegister final : public Place {
 public:
  DeviceRegister(kit::RegisterBank& bank, kit::Register& reg, unsigned low, unsigned bits)
      : bank_(bank), reg_(reg), low_(low), mask_(~uint32_t{0} >> (32 - bits)) {}

  std::optional<Change> change(const To& to) override {
    const uint32_t before = reg_.get() >> low_ & mask_;
    const auto after = static_cast<uint32_t>(to(before)) & mask_;
    if (after != before) {
      reg_.set((reg_.get() & ~(mask_ << low_)) | after << low_);
      bank_.restored();
    }
    return Change{before, after};
  }

 private:
  kit::RegisterBank& bank_;
  kit::Register& reg_;
  unsigned low_;
  uint32_t mask_;
};

/// "0x20000100" or "4096".
std::optional<uint32_t> number_in(const std::string& text) {
  const auto value = whole_number(text);
  if (!value || *value > UINT32_MAX) return std::nullopt;
  return static_cast<uint32_t>(*value);
}

bool is_own_device(const std::string& name) {
  return name.rfind("coprocessor.", 0) == 0 || name.rfind("model.", 0) == 0 ||
         name.rfind("rtl.", 0) == 0;
}

}  // namespace

nlohmann::ordered_json to_json(const ListedPlace& place) {
  return {{"place", place.name}, {"bits", place.bits}, {"unit", place.unit}};
}

Error no_such_bit(const std::string& name, unsigned bit, uint64_t bits) {
  return Error{fmt::format("{} has no bit {}; its bits are 0 to {}", name, bit, bits - 1)};
}

Places::Places(soc::Soc& soc, const run::CoprocessorBackend& backend,
               const std::vector<const loader::ElfImage*>& images)
    : soc_(soc), backend_(backend), images_(images), registers_(soc), variables_(images) {}

Result<PlacedBit> Places::find(const std::string& name, unsigned bit) const {
  if (name.rfind(processor, 0) == 0) return core_bit(name, bit);
  if (name.rfind(memory, 0) == 0) return memory_bit(name, bit);
  if (is_own_device(name)) return coprocessor_bit(name, bit);
  if (registers_.has_peripheral(name.substr(0, name.find('.')))) return device_bit(name, bit);
  std::vector<std::string> names;
  for (const soc::BoardPeripheral& each : registers_.all()) names.push_back(each.name);
  return Error{fmt::format("'{}' is no place; {}; the nearest devices are {}", printable(name, 80),
                           forms, nearest_names(name.substr(0, name.find('.')), names))};
}

Result<PlacedBit> Places::core_bit(const std::string& name, unsigned bit) const {
  const std::string own = name.substr(std::string(processor).size());
  debug::SocTarget target(soc_);
  std::vector<std::string> names;
  for (unsigned i = 0; i < debug::registers.size(); ++i) {
    const debug::Register& reg = debug::registers.at(i);
    if (!target.has_register(i)) continue;
    names.emplace_back(reg.name);
    if (own != reg.name) continue;
    const unsigned bits = bits_of(reg, soc_.cpu.core().profile());
    if (bit >= bits) return no_such_bit(name, bit, bits);
    return PlacedBit{std::make_unique<CoreRegister>(soc_, i), bit};
  }
  for (SystemField& field : system_fields(soc_.cpu.core())) {
    names.push_back(field.name);
    if (own != field.name) continue;
    if (bit >= field.bits) return no_such_bit(name, bit, field.bits);
    return PlacedBit{std::make_unique<SystemBits>(soc_.cpu.core(), std::move(field)), bit};
  }
  return Error{fmt::format("the processor has no register '{}'; did you mean {}?",
                           printable(own, 80), nearest_names(own, std::move(names)))};
}

/// Of a variable each of its bits; of an address the bits from there on to the end of the memory.
Result<PlacedBit> Places::memory_bit(const std::string& name, unsigned bit) const {
  const std::string own = name.substr(std::string(memory).size());
  const std::size_t plus = own.rfind('+');
  const std::string base = own.substr(0, plus);
  const auto offset = plus == std::string::npos ? 0U : number_in(own.substr(plus + 1));
  if (!offset)
    return Error{fmt::format("'{}' is no number of bytes; write mem:VARIABLE+8",
                             printable(own.substr(plus + 1), 40))};
  auto address = number_in(base);
  if (!address) {
    const auto variable = variables_.find(base, [this](uint32_t at) -> std::optional<uint32_t> {
      uint32_t word = 0;
      if (!soc_.read_memory(at, &word, sizeof word)) return std::nullopt;
      return word;
    });
    if (!variable) return Error{variable.error()};
    address = variable.value().address;
    const uint64_t bits = 8ULL * variable.value().size();
    if (8ULL * *offset + bit >= bits)
      return no_such_bit(fmt::format("mem:{}", base), 8 * *offset + bit, bits);
  }
  const uint64_t at = uint64_t{*address} + *offset + bit / 8;
  uint8_t byte = 0;
  if (at > UINT32_MAX || !soc_.read_memory(static_cast<uint32_t>(at), &byte, 1))
    return Error{
        fmt::format("{}: there is no memory at {:#010x}; capsoc info prints the map", name, at)};
  return PlacedBit{std::make_unique<MemoryByte>(soc_, static_cast<uint32_t>(at)), bit % 8};
}

Result<Places::OnBus> Places::on_bus(const Fault& fault) const {
  constexpr uint32_t private_bus = 0xE0000000;
  const auto found = registers_.find(fault.place);
  if (!found) return Error{found.error()};
  const auto& [reg, field] = found.value();
  if (reg->address >= private_bus)
    return Error{fmt::format("{} is the processor's own; its accesses use no bus", fault.place)};
  const unsigned low = field == nullptr ? 0 : field->low,
                 bits = field == nullptr ? 32 : field->bits;
  if (fault.is_of_bit() && fault.bit >= bits) return no_such_bit(fault.place, fault.bit, bits);
  return OnBus{reg->address, low + fault.bit};
}

kit::RegisterBank* Places::bank_at(uint32_t address, uint32_t& offset) const {
  const bus::AddressMap map = soc::board_map();
  for (kit::Component* part : soc_.components()) {
    auto* const bank = dynamic_cast<kit::RegisterBank*>(part);
    const bus::MapEntry* const entry =
        bank == nullptr ? nullptr : bus::find_entry(map, part->component_name());
    if (entry == nullptr || address < entry->base || address > entry->last()) continue;
    offset = static_cast<uint32_t>(address - entry->base + entry->offset);
    return bank;
  }
  return nullptr;
}

kit::Register* Places::register_at(uint32_t address) const {
  uint32_t offset = 0;
  const kit::RegisterBank* const bank = bank_at(address, offset);
  if (bank == nullptr) return nullptr;
  for (kit::Register* reg : bank->registers())
    if (reg->description().offset == offset && !reg->is_computed()) return reg;
  return nullptr;
}

Result<PlacedBit> Places::device_bit(const std::string& name, unsigned bit) const {
  const auto found = registers_.find(name);
  if (!found) return Error{found.error()};
  const soc::RegisterPlace& at = found.value();
  if (name.rfind("COPROCESSOR.", 0) == 0) return coprocessor_register(name, at, bit);
  uint32_t offset = 0;
  kit::RegisterBank* const bank = bank_at(at.reg->address, offset);
  kit::Register* const reg = register_at(at.reg->address);
  if (reg == nullptr)
    return Error{fmt::format(
        "{} is computed from other state, or is the processor's own; name a register that keeps "
        "a value",
        name)};
  const unsigned low = at.field != nullptr ? at.field->low : 0;
  const unsigned bits = at.field != nullptr ? at.field->bits : 32;
  if (bit >= bits) return no_such_bit(name, bit, bits);
  return PlacedBit{std::make_unique<DeviceRegister>(*bank, *reg, low, bits), bit};
}

void Places::list_devices(std::vector<ListedPlace>& list) const {
  for (const soc::BoardPeripheral& device : registers_.all())
    for (const soc::BoardRegister& reg : device.registers) {
      const kit::Register* const kept = register_at(reg.address);
      if (kept == nullptr || device.name == "COPROCESSOR") continue;
      // What a program can neither write nor clear is wired, not kept.
      const uint32_t bits =
          kept->description().writable_mask | kept->description().one_to_clear_mask;
      if (bits == 0) continue;
      list.push_back({device.name + "." + reg.name, 32U - __builtin_clz(bits), device.name});
    }
}

/// The segments of the programs.
void Places::list_memories(std::vector<ListedPlace>& list) const {
  const bus::AddressMap map = soc::board_map();
  for (const loader::ElfImage* image : images_)
    for (const loader::Segment& segment : image->segments) {
      if (segment.memory_size == 0) continue;
      std::string unit = "memory";
      for (const bus::MapEntry& entry : map)
        if (segment.address >= entry.base && segment.address <= entry.last()) unit = entry.name;
      list.push_back(
          {fmt::format("mem:{:#010x}", segment.address), 8ULL * segment.memory_size, unit});
    }
}

std::vector<ListedPlace> Places::all() const {
  std::vector<ListedPlace> list;
  list.reserve(debug::registers.size());
  debug::SocTarget target(soc_);
  for (unsigned i = 0; i < debug::registers.size(); ++i) {
    const debug::Register& reg = debug::registers.at(i);
    if (target.has_register(i))
      list.push_back({std::string(processor) + reg.name, bits_of(reg, soc_.cpu.core().profile()),
                      "processor"});
  }
  for (const SystemField& field : system_fields(soc_.cpu.core()))
    list.push_back({processor + field.name, field.bits, field.unit});
  list_memories(list);
  list_devices(list);
  list_coprocessor(list);
  return list;
}

}  // namespace capsoc::inject
