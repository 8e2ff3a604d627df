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
  static const char* names[] = {"eq", "ne", "hs", "lo", "mi", "pl", "vs", "vc",
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

const char* shift_name(const DecodedOp& op) {
  static const char* names[] = {"lsl", "lsr", "asr", "ror", "rrx"};
  return names[static_cast<unsigned>(op.shift_type)];
}

std::string shift_text(const DecodedOp& op) {
  if (op.shift_n == 0) return "";
  if (op.shift_type == ShiftType::rrx) return ", rrx";
  return std::string(", ") + shift_name(op) + " #" + std::to_string(op.shift_n);
}

/// ", #offset", nothing for zero.
std::string offset_text(const DecodedOp& op) {
  return op.imm == 0 ? "" : ", #" + std::to_string(static_cast<int32_t>(op.imm));
}

/// The then and else of an IT instruction behind its first condition.
std::string it_text(uint32_t it) {
  std::string text;
  for (unsigned at = 3; at > 0 && (it & ((1u << at) - 1)) != 0; --at)
    text += ((it >> at) & 1) == ((it >> 4) & 1) ? 't' : 'e';
  return text + " " + (it >> 4 == 14 ? "al" : condition_name(it >> 4));
}

/// The register that MRS and MSR name (B5.1.1).
std::string special_name(uint32_t encoding) {
  static const char* names[] = {
      "apsr",        "iapsr",     "eapsr",  "xpsr", "", "ipsr", "epsr", "iepsr",   "msp",
      "psp",         "",          "",       "",     "", "",     "",     "primask", "basepri",
      "basepri_max", "faultmask", "control"};
  const uint32_t which = encoding & 0xFF;
  return which < 21 && *names[which] != 0 ? names[which] : std::to_string(which);
}

std::string option_text(uint32_t encoding) {
  return (encoding & 15) == 15 ? "sy" : hex(encoding & 15);
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
      return "[" + base + offset_text(op) + "]";
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
  if (field == "amount") return std::to_string(op.shift_n);
  if (field == "width") return std::to_string(op.ra + 1u - op.imm);
  if (field == "bits") return std::to_string(op.ra + 1u);
  if (field == "rotation") return op.shift_n == 0 ? "" : ", ror #" + std::to_string(op.shift_n);
  if (field == "mov") return op.shift_n == 0 ? "mov" : shift_name(op);
  if (field == "mov_shift")
    return op.shift_n == 0 || op.shift_type == ShiftType::rrx ? ""
                                                              : ", #" + std::to_string(op.shift_n);
  if (field == "offset") return offset_text(op);
  if (field == "it") return it_text(op.imm);
  if (field == "cps")
    return std::string((op.encoding & 16) ? "id " : "ie ") + ((op.encoding & 2) ? "i" : "") +
           ((op.encoding & 1) ? "f" : "");
  if (field == "special") return special_name(op.encoding);
  if (field == "option") return option_text(op.encoding);
  if (field == "address") return address_text(op);
  if (field == "target") return hex(pc_of(op) + op.imm);
  return "?";
}

}  // namespace

std::string disassemble(const DecodedOp& op) {
  const Encoding* line = find_encoding(op.encoding, op.size);
  const bool named = line != nullptr && line->operation == Operation::undefined;
  if (op.operation == Operation::undefined && !named) return "undefined " + hex(op.encoding);
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
