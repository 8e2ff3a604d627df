#include <cctype>
#include <cstdio>

#include "cortex_m3/decoder.h"

namespace capsoc::cortex_m3 {
namespace {

std::string register_name(unsigned n) {
  static const char* special[] = {"sp", "lr", "pc"};
  return n < 13 ? "r" + std::to_string(n) : special[n - 13];
}

std::string hex(uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof(text), "0x%x", static_cast<unsigned>(value));
  return text;
}

std::string condition_name(unsigned condition) {
  static const char* names[] = {"eq", "ne", "cs", "cc", "mi", "pl", "vs", "vc",
                                "hi", "ls", "ge", "lt", "gt", "le", "",   ""};
  return names[condition & 15];
}

std::string list_text(uint32_t list) {
  std::string text = "{";
  for (unsigned n = 0; n < 16; ++n) {
    if (((list >> n) & 1) == 0) continue;
    text += (text.size() > 1 ? ", " : "") + register_name(n);
  }
  return text + "}";
}

std::string shift_text(const DecodedOp& op) {
  static const char* names[] = {"lsl", "lsr", "asr", "ror", "rrx"};
  if (op.shift_n == 0) return "";
  return std::string(", ") + names[static_cast<unsigned>(op.shift_type)] + " #" +
         std::to_string(op.shift_n);
}

std::string address_text(const DecodedOp& op) {
  std::string base = register_name(op.addressing == Addressing::literal ? 15 : op.rn);
  std::string offset = "#" + std::to_string(static_cast<int32_t>(op.imm));
  switch (op.addressing) {
    case Addressing::reg:
      return "[" + base + ", " + register_name(op.rm) + shift_text(op) + "]";
    case Addressing::pre_indexed:
      return "[" + base + ", " + offset + "]!";
    case Addressing::post_indexed:
      return "[" + base + "], " + offset;
    default:
      return "[" + base + ", " + offset + "]";
  }
}

std::string field_text(const std::string& field, const DecodedOp& op) {
  if (field == "d") return register_name(op.rd);
  if (field == "n") return register_name(op.rn);
  if (field == "m") return register_name(op.rm);
  if (field == "a") return register_name(op.ra & 15);
  if (field == "b") return std::to_string(op.ra);
  if (field == "c") return condition_name(op.shift_n);
  if (field == "s") return op.set_flags ? "s" : "";
  if (field == "w") return op.writeback ? "!" : "";
  if (field == "i") return hex(op.imm);
  if (field == "list") return list_text(op.imm);
  if (field == "shift") return shift_text(op);
  if (field == "address") return address_text(op);
  if (field == "target") return hex(pc_of(op) + op.imm);
  return "?";
}

}  // namespace

std::string disassemble(const DecodedOp& op) {
  if (op.operation == Operation::undefined) return "undefined " + hex(op.encoding);
  unsigned index = op.encoding_index_low | static_cast<unsigned>(op.encoding_index_high) << 8;
  std::string text;
  for (const char* p = encodings()[index].assembly; *p != 0; ++p) {
    if (*p != '{') {
      text += *p;
      continue;
    }
    std::string field;
    while (*++p != '}') field += *p;
    text += field_text(field, op);
  }
  if (op.condition == condition_always) return text;
  std::size_t end = text.find_first_of(" .");
  return text.insert(end == std::string::npos ? text.size() : end, condition_name(op.condition));
}

}  // namespace capsoc::cortex_m3
