#include "soc/board_registers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <string_view>

#include "armv7m/system/registers.h"
#include "capsoc_registers.h"
#include "soc/board_map.h"

namespace capsoc::soc {

/// models/registers/capsoc.svd.
extern const std::string_view own_description;

namespace {

using registers::Access;
using registers::RegisterDescription;

/// Of devices whose registers are a generated table.
struct OwnTable {
  const char* name;
  uint32_t base;
  const RegisterDescription* first;
  std::size_t count;
  const registers::FieldDescription* fields;
  std::size_t field_count;
};
constexpr OwnTable own_tables[] = {
    {"COPROCESSOR", registers::coprocessor::base_address, registers::coprocessor::table,
     std::size(registers::coprocessor::table), registers::coprocessor::fields,
     std::size(registers::coprocessor::fields)},
    {"ADC", registers::adc::base_address, registers::adc::table, std::size(registers::adc::table),
     registers::adc::fields, std::size(registers::adc::fields)},
    {"CLOCKCTRL", registers::clockctrl::base_address, registers::clockctrl::table,
     std::size(registers::clockctrl::table), registers::clockctrl::fields,
     std::size(registers::clockctrl::fields)},
};

const OwnTable* own_table(uint64_t base) {
  for (const OwnTable& table : own_tables)
    if (table.base == base) return &table;
  return nullptr;
}

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

/// UART for UART3.
std::string kind_of(const std::string& peripheral) {
  return peripheral.substr(0, peripheral.find_last_not_of("0123456789") + 1);
}

const char* description_of(const std::string& kind) {
  static constexpr const char* descriptions[][2] = {
      {"UART", "CMSDK APB UART"},
      {"TIMER", "CMSDK APB timer"},
      {"DUAL_TIMER", "CMSDK dual-input timer"},
      {"WATCHDOG", "CMSDK watchdog"},
      {"GPIO", "CMSDK AHB GPIO, 16 pins"},
      {"FPGAIO", "FPGA system control and I/O of the AN385"},
      {"SCC", "Serial configuration controller of the AN385"},
      {"ITM", "Instrumentation trace macrocell"},
      {"DWT", "Data watchpoint and trace"},
      {"SCNSCB", "System control not in the SCB"},
      {"SYSTICK", "System timer"},
      {"NVIC", "Nested vectored interrupt controller"},
      {"SCB", "System control block"},
      {"MPU", "Memory protection unit"},
      {"DCB", "Debug control block"},
      {"FPU", "Floating-point unit"},
  };
  for (const auto& [name, text] : descriptions)
    if (kind == name) return text;
  return "Device of the board";
}

void add_fields(const std::string& kind, BoardRegister& target) {
  struct Row {
    const char *kind, *reg, *name;
    unsigned low, bits;
  };
  static constexpr Row rows[] = {
#define REGISTER_FIELD(kind, reg, name, low, bits) {#kind, #reg, #name, low, bits},
#include "soc/register_fields.def"
#undef REGISTER_FIELD
  };
  const RegisterDescription& about = target.description;
  const uint64_t known = about.readable_mask | about.writable_mask | about.one_to_clear_mask;
  for (const Row& row : rows) {
    const uint64_t mask = ((uint64_t{1} << row.bits) - 1) << row.low;
    if (kind == row.kind && target.name == row.reg && (mask & ~known) == 0)
      target.fields.push_back({row.name, row.low, row.bits});
  }
}

void add_register(BoardPeripheral& peripheral, BoardRegister added) {
  add_fields(kind_of(peripheral.name), added);
  peripheral.registers.push_back(std::move(added));
}

void add_own_registers(BoardPeripheral& peripheral, const OwnTable& own) {
  for (std::size_t i = 0; i < own.count; ++i) {
    BoardRegister added{own.first[i].name, own.base + own.first[i].offset, own.first[i], false, {}};
    for (std::size_t k = 0; k < own.field_count; ++k)
      if (added.name == own.fields[k].reg)
        added.fields.push_back({own.fields[k].name, own.fields[k].low, own.fields[k].bits});
    peripheral.registers.push_back(std::move(added));
  }
}

BoardPeripheral device(const bus::MapEntry& entry, const Soc& soc) {
  BoardPeripheral peripheral;
  const auto base = static_cast<uint32_t>(entry.base);
  const OwnTable* const own = own_table(entry.base);
  peripheral.name = own != nullptr ? own->name : upper(entry.name);
  peripheral.description = description_of(kind_of(peripheral.name));
  peripheral.blocks.push_back({base, static_cast<uint32_t>(entry.size)});
  for (const bus::InterruptWire& wire : entry.interrupts) {
    if (wire.line < 0) continue;
    const bool only = wire.output == "interrupt" || wire.output == "combined";
    peripheral.interrupts.push_back(
        {only ? peripheral.name : peripheral.name + "_" + upper(wire.output), wire.line});
  }
  if (own != nullptr) {
    add_own_registers(peripheral, *own);
    return peripheral;
  }
  for (const kit::Component* part : soc.components()) {
    const auto* const bank = dynamic_cast<const kit::RegisterBank*>(part);
    if (bank == nullptr || part->component_name() != entry.name) continue;
    for (const kit::Register* each : bank->registers()) {
      const RegisterDescription& about = each->description();
      add_register(peripheral,
                   {about.name, base + about.offset, about, each->is_changed_by_reads(), {}});
    }
  }
  std::sort(peripheral.registers.begin(), peripheral.registers.end(),
            [](const auto& a, const auto& b) { return a.address < b.address; });
  return peripheral;
}

/// Where a register of the private peripheral bus belongs in the words of CMSIS.
struct CorePlace {
  const char* peripheral;
  uint32_t base, size;
  const char* prefix;  ///< of its registers' names in registers.def
};
constexpr CorePlace core_places[] = {
    {"ITM", 0xE0000000, 0x1000, "ITM_"},  {"DWT", 0xE0001000, 0x1000, "DWT_"},
    {"SCNSCB", 0xE000E000, 0x10, ""},     {"SYSTICK", 0xE000E010, 0x10, "SYST_"},
    {"NVIC", 0xE000E100, 0x400, "NVIC_"}, {"SCB", 0xE000ED00, 0x90, ""},
    {"MPU", 0xE000ED90, 0x2C, "MPU_"},    {"DCB", 0xE000EDF0, 0x10, ""},
    {"NVIC", 0xE000EF00, 0x4, ""},        {"FPU", 0xE000EF34, 0x14, ""},
};

/// The name of one word of a row of registers.def; "" of a reserved one.
std::string word_name(const armv7m::SystemRegister& row, unsigned word, const std::string& prefix) {
  std::string name = row.description.name;
  if (name.rfind(prefix, 0) == 0) name = name.substr(prefix.size());
  switch (row.address()) {
    case armv7m::ppb::DWT_COMP0: {
      static constexpr const char* of_four[] = {"COMP", "MASK", "FUNCTION", ""};
      const char* const one = of_four[word % 4];
      return *one == '\0' ? "" : fmt::format("{}{}", one, word / 4);
    }
    case armv7m::ppb::MPU_RBAR: {
      const char* const one = word % 2 == 0 ? "RBAR" : "RASR";
      return word < 2 ? one : fmt::format("{}_A{}", one, word / 2);
    }
    case armv7m::ppb::SHPR:
      return fmt::format("{}{}", name, word + 1);
    default:
      return row.words == 1 ? name : fmt::format("{}{}", name, word);
  }
}

void add_core_registers(const armv7m::SystemRegisters& registers, const CorePlace& place,
                        BoardPeripheral& peripheral) {
  for (uint32_t address = place.base; address < place.base + place.size; address += 4) {
    const armv7m::SystemRegister* const row = registers.find(address);
    if (row == nullptr) continue;
    const std::string name = word_name(*row, (address - row->address()) / 4, place.prefix);
    // Reading CSR clears COUNTFLAG.
    const bool changes = row->address() == armv7m::ppb::SYST_CSR;
    if (!name.empty()) add_register(peripheral, {name, address, row->description, changes, {}});
  }
}

const char* access_name(Access access) {
  switch (access) {
    case Access::read_only:
      return "read-only";
    case Access::write_only:
      return "write-only";
    case Access::read_write:
      break;
  }
  return "read-write";
}

std::string to_svd(const BoardRegister& each, uint32_t base) {
  const RegisterDescription& about = each.description;
  std::string text = fmt::format(
      "        <register>\n          <name>{}</name>\n          "
      "<addressOffset>{:#x}</addressOffset>\n"
      "          <access>{}</access>\n          <resetValue>{:#010x}</resetValue>\n",
      each.name, each.address - base, access_name(about.access), about.reset);
  if (about.one_to_clear_mask != 0 && about.writable_mask == 0)
    text += "          <modifiedWriteValues>oneToClear</modifiedWriteValues>\n";
  if (each.reads_change) text += "          <readAction>modify</readAction>\n";
  if (!each.fields.empty()) {
    text += "          <fields>\n";
    for (const RegisterField& field : each.fields)
      text +=
          fmt::format("            <field><name>{}</name><bitRange>[{}:{}]</bitRange></field>\n",
                      field.name, field.low + field.bits - 1, field.low);
    text += "          </fields>\n";
  }
  return text + "        </register>\n";
}

std::string to_svd(const BoardPeripheral& peripheral) {
  const uint32_t base = peripheral.blocks.front().base;
  std::string text = fmt::format(
      "    <peripheral>\n      <name>{}</name>\n      <description>{}</description>\n"
      "      <baseAddress>{:#010x}</baseAddress>\n",
      peripheral.name, peripheral.description, base);
  for (const BoardPeripheral::Block& block : peripheral.blocks)
    text += fmt::format(
        "      <addressBlock><offset>{:#x}</offset><size>{:#x}</size>"
        "<usage>registers</usage></addressBlock>\n",
        block.base - base, block.size);
  for (const BoardPeripheral::Interrupt& interrupt : peripheral.interrupts)
    text += fmt::format("      <interrupt><name>{}</name><value>{}</value></interrupt>\n",
                        interrupt.name, interrupt.line);
  text += "      <registers>\n";
  for (const BoardRegister& each : peripheral.registers) text += to_svd(each, base);
  return text + "      </registers>\n    </peripheral>\n";
}

}  // namespace

std::vector<BoardPeripheral> board_peripherals(const Soc& soc) {
  std::vector<BoardPeripheral> all;
  for (const bus::MapEntry& entry : board_map())
    if (entry.kind == bus::TargetKind::device) all.push_back(device(entry, soc));
  for (const CorePlace& place : core_places) {
    BoardPeripheral part;
    part.name = place.peripheral;  // of the fields
    add_core_registers(*soc.cpu.core().profile().registers, place, part);
    if (part.registers.empty()) continue;  // the processor has none of them
    auto found = std::find_if(all.begin(), all.end(),
                              [&](const auto& each) { return each.name == place.peripheral; });
    if (found == all.end()) {
      all.push_back({place.peripheral, description_of(place.peripheral), {}, {}, {}});
      found = all.end() - 1;
    }
    found->blocks.push_back({place.base, place.size});
    found->registers.insert(found->registers.end(), part.registers.begin(), part.registers.end());
  }
  return all;
}

std::string board_svd(const Soc& soc) {
  constexpr std::string_view begin = "  <peripherals>\n", end = "  </peripherals>";
  std::string text(own_description);
  // What is said there of that file alone.
  const std::size_t comment = text.find("<!--"), behind = text.find("-->\n");
  if (comment != std::string::npos && behind != std::string::npos)
    text.replace(comment, behind - comment + 4,
                 "<!-- The registers of the whole board, as its models declare them. -->\n");
  std::string others;
  for (const BoardPeripheral& peripheral : board_peripherals(soc))
    if (own_table(peripheral.blocks.front().base) == nullptr) others += to_svd(peripheral);
  const std::size_t at = text.find(end);
  if (at == std::string::npos || text.find(begin) == std::string::npos) return text;
  return text.insert(at, others);
}

}  // namespace capsoc::soc
