// Memory, and the program's variables in it.
#include <fmt/format.h>

#include <algorithm>

#include "base/printable.h"
#include "service/board_verbs.h"
#include "service/expression.h"
#include "service/value.h"

namespace capsoc::service {
namespace {

constexpr uint64_t longest_read = uint64_t{64} << 20;

Answer nothing_there(uint64_t address) {
  return refuse(
      fmt::format("nothing can be read or written at {:#010x}; `capsoc info` prints the "
                  "address map",
                  address));
}

Answer read_memory(Board& board, const Call& call) {
  const auto address = board.address(call.json("address"));
  if (!address) return refuse(address.error());
  const uint64_t size = call.integer("size");
  if (size > longest_read)
    return refuse(fmt::format("memory.read: {} bytes are more than 64 MiB; read in pieces", size),
                  Code::wrong_parameter);
  std::string bytes = board.target().read_memory(address.value(), static_cast<uint32_t>(size));
  const bool may_be_short = call.has("short") && call.boolean("short");
  if (bytes.size() < size && !may_be_short) return nothing_there(address.value() + bytes.size());
  Answer answer;
  answer.add_bytes("bytes", std::move(bytes));
  return answer;
}

Answer write_memory(Board& board, const Call& call) {
  const auto address = board.address(call.json("address"));
  if (!address) return refuse(address.error());
  if (!board.target().write_memory(address.value(), call.bytes("bytes")))
    return nothing_there(address.value());
  return {};
}

/// The bytes that hold a variable, a bit-field with those around it.
std::string bytes_of_variable(Board& board, const source::Variable& variable) {
  const uint32_t size = variable.size();
  std::string bytes = board.target().read_memory(variable.address, size);
  return bytes.size() == size ? bytes : "";
}

Result<source::Variable> find(Board& board, const Call& call) {
  return board.variables().find(call.text("name"), board.pointers());
}

Answer read_variable(Board& board, const Call& call) {
  const auto variable = find(board, call);
  if (!variable) return refuse(variable.error());
  const std::string bytes = bytes_of_variable(board, variable.value());
  if (bytes.empty() && variable.value().type->size > 0)
    return nothing_there(variable.value().address);
  Answer answer;
  answer.result = {{"value", value_of(variable.value(), bytes)},
                   {"type", variable.value().type->name},
                   {"address", variable.value().address}};
  return answer;
}

Answer write_variable(Board& board, const Call& call) {
  const auto variable = find(board, call);
  if (!variable) return refuse(variable.error());
  const std::string old = bytes_of_variable(board, variable.value());
  if (old.empty()) return nothing_there(variable.value().address);
  const auto bytes = bytes_of(variable.value(), call.json("value"), old);
  if (!bytes) return refuse(bytes.error());
  if (!board.target().write_memory(variable.value().address, bytes.value()))
    return nothing_there(variable.value().address);
  return {};
}

Answer evaluate(Board& board, const Call& call) {
  const auto expression = Expression::parse(call.text("text"));
  if (!expression) return refuse(expression.error(), Code::wrong_parameter);
  const auto value =
      expression.value().value([&](const std::string& name) { return board.number_of(name); });
  if (!value) return refuse(value.error());
  Answer answer;
  answer.result["value"] = value.value();
  return answer;
}

Answer list_variables(Board& board, const Call&) {
  Answer answer;
  Json& list = answer.result["variables"] = Json::array();
  for (const source::Variable& each : board.variables().all())
    list.push_back({{"name", each.name},
                    {"type", each.type->name},
                    {"address", each.address},
                    {"size", each.type->size}});
  return answer;
}

}  // namespace

std::vector<BoardVerb> memory_verbs() {
  return {
      {{"memory.read",
        "Bytes as the debug port of the bus sees them: without side effects and without time.",
        {need("address", Type::address, "of the first byte"),
         need("size", Type::integer, "bytes, at most 64 MiB"),
         may("short", Type::boolean, "it may be fewer: those before the first that is nowhere")},
        {{"bytes", "array", "all of them"}}},
       read_memory,
       Effect::looks},
      {{"memory.write",
        "Writes bytes. A device takes them as writes of the bus, in the largest aligned pieces.",
        {need("address", Type::address, "of the first byte"),
         need("bytes", Type::bytes, "what is written")},
        {}},
       write_memory,
       Effect::input},
      {{"variable.read",
        "A variable of the program by its name in the source: `turns`, `state.angle`, `table[3]`, "
        "`list->next`, `*pointer`, `main.c::count`.",
        {need("name", Type::text, "the variable, or a part of it")},
        {{"value", "any",
          "an object of a structure, a list of an array, a text of an array of char, the name of "
          "an enumerator"},
         {"type", "text", "as C writes it"},
         {"address", "integer", "where it lies"}}},
       read_variable,
       Effect::looks},
      {{"variable.write",
        "Writes a variable, or parts of it: an object names the members that change.",
        {need("name", Type::text, "as in variable.read"),
         need("value", Type::any, "as variable.read gives it")},
        {}},
       write_variable,
       Effect::input},
      {{"expression.read",
        "What an expression of simulation.advance is worth now.",
        {need("text", Type::text, "turns > 3 and COPROCESSOR.STATUS.LOCK == 1")},
        {{"value", "number", "true is 1"}}},
       evaluate,
       Effect::looks},
      {{"variable.list",
        "The variables that lie in memory for the whole run, by name.",
        {},
        {{"variables", "list", "of objects: name, type, address, size in bytes"}}},
       list_variables,
       Effect::looks},
  };
}

}  // namespace capsoc::service
