// Registers of the processor, of the devices and of the coprocessor.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>

#include "base/nearest.h"
#include "base/printable.h"
#include "service/board_verbs.h"
#include "service/signals.h"
#include "soc/board_registers.h"
#include "soc/register_index.h"

namespace capsoc::service {
namespace {

Answer read_processor(Board& board, const Call&) {
  Answer answer;
  Json& all = answer.result["registers"] = Json::object();
  for (unsigned i = 0; i < debug::registers.size(); ++i)
    if (board.target().has_register(i))
      all[debug::registers[i].name] = board.target().read_register(i);
  return answer;
}

Answer write_processor(Board& board, const Call& call) {
  const std::string name = call.text("register");
  const uint64_t value = call.integer("value");
  const auto index = processor_register(board.target(), name);
  if (!index) return refuse(index.error());
  if (value >> debug::registers[index.value()].bits != 0)
    return refuse(fmt::format("{} has {} bits", name, debug::registers[index.value()].bits));
  board.target().write_register(index.value(), static_cast<uint32_t>(value));
  return {};
}

Json fields_of(const soc::BoardRegister& reg, uint32_t word) {
  Json fields = Json::object();
  for (const soc::RegisterField& field : reg.fields)
    fields[field.name] = soc::value_in(field, word);
  return fields;
}

Answer read_register(Board& board, const Call& call) {
  const auto place = board.registers().find(call.text("name"));
  if (!place) return refuse(place.error());
  const soc::RegisterPlace& at = place.value();
  const auto word = board.read_word(at.reg->address);
  if (!word) return refuse(fmt::format("{} cannot be read", call.text("name")));
  Answer answer;
  if (at.field != nullptr)
    answer.result["value"] = soc::value_in(*at.field, *word);
  else
    answer.result = {{"value", *word}, {"fields", fields_of(*at.reg, *word)}};
  return answer;
}

Answer write_register(Board& board, const Call& call) {
  const auto place = board.registers().find(call.text("name"));
  if (!place) return refuse(place.error());
  const soc::RegisterPlace& at = place.value();
  const uint64_t value = call.integer("value");
  const unsigned bits = at.field != nullptr ? at.field->bits : 32;
  if (value >> bits != 0) return refuse(fmt::format("{} has {} bits", call.text("name"), bits));
  auto word = static_cast<uint32_t>(value);
  if (at.field != nullptr) {
    const auto old = board.read_word(at.reg->address);
    const uint64_t mask = ((uint64_t{1} << bits) - 1) << at.field->low;
    word = static_cast<uint32_t>((old.value_or(0) & ~mask) | value << at.field->low);
  }
  std::string bytes;
  for (unsigned i = 0; i < 4; ++i) bytes += static_cast<char>(word >> 8 * i & 0xFFU);
  if (!board.target().write_memory(at.reg->address, bytes))
    return refuse(fmt::format("{} cannot be written", call.text("name")));
  return {};
}

Answer list_registers(Board& board, const Call&) {
  Answer answer;
  Json& list = answer.result["peripherals"] = Json::array();
  for (const soc::BoardPeripheral& peripheral : board.registers().all()) {
    Json registers = Json::array();
    for (const soc::BoardRegister& reg : peripheral.registers) {
      Json fields = Json::array();
      for (const soc::RegisterField& field : reg.fields)
        fields.push_back({{"name", field.name}, {"low", field.low}, {"bits", field.bits}});
      registers.push_back(
          {{"name", reg.name}, {"address", reg.address}, {"fields", std::move(fields)}});
    }
    list.push_back({{"name", peripheral.name},
                    {"description", peripheral.description},
                    {"registers", std::move(registers)}});
  }
  return answer;
}

Answer read_coprocessor(Board& board, const Call&) {
  const auto& samples = board.samples();
  const auto newest = std::find_if(samples.rbegin(), samples.rend(),
                                   [](const auto& sample) { return sample.result.has_value(); });
  if (newest == samples.rend())
    return refuse("the coprocessor has no result yet; advance until it has taken a sample");
  Answer answer;
  answer.result["signals"] = coprocessor_signals(*newest->result);
  return answer;
}

}  // namespace

std::vector<BoardVerb> register_verbs() {
  return {
      {{"processor.read",
        "The registers of the processor, with the names that GDB has for them.",
        {},
        {{"registers", "object", "r0 to r12, sp, lr, pc, xpsr, msp, psp, primask, ..."}}},
       read_processor,
       Effect::looks},
      {{"processor.write",
        "Writes a register of the processor.",
        {need("register", Type::text, "its name"), need("value", Type::integer, "the new value")},
        {}},
       write_processor,
       Effect::input},
      {{"register.read",
        "A register of a device, or one of its fields, by the names of the SVD file "
        "(COPROCESSOR.STATUS, COPROCESSOR.STATUS.LOCK). Nothing happens by being read so.",
        {need("name", Type::text, "PERIPHERAL.REGISTER or PERIPHERAL.REGISTER.FIELD")},
        {{"value", "integer", "of the register or the field"},
         {"fields", "object", "of a register: the value of each field"}}},
       read_register,
       Effect::looks},
      {{"register.write",
        "Writes a register as the processor would. With a field the other bits are written as "
        "they are read.",
        {need("name", Type::text, "as in register.read"),
         need("value", Type::integer, "the new value")},
        {}},
       write_register,
       Effect::input},
      {{"register.list",
        "All registers of the board.",
        {},
        {{"peripherals", "list",
          "of objects: name, description, registers (name, address, fields: name, low, bits)"}}},
       list_registers,
       Effect::looks},
      {{"coprocessor.read",
        "What the coprocessor held when its newest result was committed.",
        {},
        {{"signals", "object",
          "a1, a2, b1, b2, error_u, error_v, error_average (full scale), beta_deg, phi_deg, "
          "angle_deg, angle_valid, status, flags"}}},
       read_coprocessor,
       Effect::looks},
  };
}

}  // namespace capsoc::service
