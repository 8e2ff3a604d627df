#include <cctype>
#include <cstdio>
#include <cstring>

#include "armv7m/isa/decoder.h"

namespace capsoc::armv7m {
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

std::string list_text(RegisterList list) {
  std::string text = "{";
  for (unsigned n = 0; n < 16; ++n) {
    if (!list.has(n)) continue;
    text += (text.size() > 1 ? ", " : "") + register_name(n);
  }
  return text + "}";
}

const char* shift_name(const DecodedOp& op) {
  static const char* names[] = {"lsl", "lsr", "asr", "ror", "rrx"};
  return names[static_cast<unsigned>(op.shift.type)];
}

std::string shift_text(const DecodedOp& op) {
  if (op.shift.amount == 0) return "";
  if (op.shift.type == ShiftType::rrx) return ", rrx";
  return std::string(", ") + shift_name(op) + " #" + std::to_string(op.shift.amount);
}

/// ", #offset", nothing for zero.
std::string offset_text(const DecodedOp& op) {
  return op.imm == 0 ? "" : ", #" + std::to_string(static_cast<int32_t>(op.imm));
}

/// The then and else of an IT instruction after its first condition.
std::string it_text(uint32_t it) {
  std::string text;
  for (unsigned at = 3; at > 0 && (it & ((1u << at) - 1)) != 0; --at)
    text += ((it >> at) & 1) == ((it >> 4) & 1) ? 't' : 'e';
  return text + " " + (it >> 4 == 14 ? "al" : condition_name(it >> 4));
}

/// The register that MRS and MSR name (B5.1.1).
std::string special_name(const DecodedOp& op) {
  static const char* names[] = {
      "apsr",        "iapsr",     "eapsr",  "xpsr", "", "ipsr", "epsr", "iepsr",   "msp",
      "psp",         "",          "",       "",     "", "",     "",     "primask", "basepri",
      "basepri_max", "faultmask", "control"};
  const uint32_t which = op.encoding & 0xFF;
  if (which >= 21 || *names[which] == 0) return std::to_string(which);
  if (op.operation == Operation::mrs || which >= 4) return names[which];
  const bool others = (op.encoding & 1u << 11) != 0;
  const std::string parts = !op.sets_ge ? "_nzcvq" : others ? "_nzcvqg" : "_g";
  return names[which] + parts;
}

/// The limits of a barrier; only SY is defined, the others are reserved and act as it (A7.7.33).
std::string option_text(const DecodedOp& op) {
  static const char* names[16] = {"", "", "oshst", "osh", "", "", "nshst", "nsh",
                                  "", "", "ishst", "ish", "", "", "st",    "sy"};
  const bool named =
      *names[op.imm & 15] != 0 && (op.operation == Operation::barrier || op.imm == 15);
  return named ? names[op.imm & 15] : "#" + hex(op.imm);
}

/// The hints that do nothing here (A5.2.5, A5.3.4).
std::string hint_text(uint32_t number, unsigned size) {
  if (number == 0) return "nop";
  if (number == 1) return "yield";
  if (size == 4 && number >= 0xF0) return "dbg #" + std::to_string(number & 15);
  return "hint #" + std::to_string(number);
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

/// The half of an operand of SMUL<x><y> and its like.
std::string half_name(uint32_t top) {
  return top != 0 ? "t" : "b";
}

std::string fp_register(bool is_double, unsigned single) {
  return is_double ? "d" + std::to_string(single / 2) : "s" + std::to_string(single);
}

std::string fp_list_text(const DecodedOp& op) {
  const bool is_double = fp_operand::is_double(op);
  const unsigned first = fp_operand::first(op), end = first + fp_operand::count(op);
  std::string text = "{";
  for (unsigned n = first; n < end; n += is_double ? 2 : 1)
    text += (n == first ? "" : ", ") + fp_register(is_double, n);
  return text + "}";
}

/// What single_precision.h makes of the bits, as a number that an assembler reads.
std::string fp_number(uint32_t bits) {
  float value = 0;
  std::memcpy(&value, &bits, sizeof value);
  char text[32];
  std::snprintf(text, sizeof(text), "%e", static_cast<double>(value));
  return text;
}

/// Fields of the floating-point extension; "?" for others.
std::string fp_field_text(const std::string& field, const DecodedOp& op) {
  const bool is_double = fp_operand::is_double(op), bit7 = (op.encoding & 0x80) != 0;
  const bool transfers = is(op, kind::fp_transfer);
  const bool odd = is_double && (op.encoding & 1) != 0;  // FLDMX, FSTMX
  if (field == "f")
    return fp_register(is_double, transfers ? fp_operand::first(op) : fp_operand::d(op));
  if (field == "g") return fp_register(false, fp_operand::n(op));
  if (field == "h")
    return fp_register(is_double, is_double ? fp_operand::pair(op) : fp_operand::m(op));
  if (field == "h+1") return fp_register(false, fp_operand::m(op) + 1);
  if (field == "scalar")
    return fp_register(true, fp_operand::moved(op)) +
           ((fp_operand::moved(op) & 1) != 0 ? "[1]" : "[0]");
  if (field == "fp_list") return fp_list_text(op);
  if (field == "fldm") return odd ? "fldm" : "vldm";
  if (field == "fstm") return odd ? "fstm" : "vstm";
  if (field == "vpop") return odd ? "fldmiax sp!," : "vpop";
  if (field == "vpush") return odd ? "fstmdbx sp!," : "vpush";
  if (field == "x") return odd ? "x" : "";
  if (field == "number") return fp_number(op.imm);
  if (field == "top") return bit7 ? "t" : "b";
  if (field == "signals") return bit7 ? "e" : "";
  if (field == "by_mode") return bit7 ? "" : "r";
  if (field == "fixed")
    return std::string((op.encoding & 1u << 16) != 0 ? "u" : "s") + (bit7 ? "32" : "16");
  if (field == "flags") return op.rd == 15 ? "apsr_nzcv" : register_name(op.rd);
  return "?";
}

std::string field_text(const std::string& field, const DecodedOp& op) {
  if (field == "d") return register_name(op.rd);
  if (field == "n") return register_name(op.rn);
  if (field == "m") return register_name(op.rm);
  if (field == "a") return register_name(op.ra);
  if (field == "c") return condition_name(branch_condition(op));
  if (field == "s") return op.set_flags ? "s" : "";
  if (field == "w") return op.writeback ? "!" : "";
  if (field == "i") return hex(op.imm);
  if (field == "list") return list_text(op.list);
  if (field == "shift") return shift_text(op);
  if (field == "amount") return std::to_string(op.shift.amount);
  if (field == "lsb") return hex(op.field.lsb);
  if (field == "width") return std::to_string(op.field.width);
  if (field == "rotation")
    return op.shift.amount == 0 ? "" : ", ror #" + std::to_string(op.shift.amount);
  if (field == "half") return half_name(op.imm & 1);
  if (field == "halves") return half_name(op.imm >> 1) + half_name(op.imm & 1);
  if (field == "exchange") return (op.imm & 1) != 0 ? "x" : "";
  if (field == "rounding") return (op.imm & 1) != 0 ? "r" : "";
  if (field == "mov") return op.shift.amount == 0 ? "mov" : shift_name(op);
  if (field == "mov_shift")
    return op.shift.amount == 0 || op.shift.type == ShiftType::rrx
               ? ""
               : ", #" + std::to_string(op.shift.amount);
  if (field == "offset") return offset_text(op);
  if (field == "it") return it_text(op.imm);
  if (field == "cps")
    return std::string((op.encoding & 16) ? "id " : "ie ") + ((op.encoding & 2) ? "i" : "") +
           ((op.encoding & 1) ? "f" : "");
  if (field == "hint") return hint_text(op.imm, op.size);
  if (field == "special") return special_name(op);
  if (field == "option") return option_text(op);
  if (field == "address") return address_text(op);
  if (field == "target") return hex(pc_of(op) + op.imm);
  return fp_field_text(field, op);
}

/// What a load of a byte or halfword to R15 is (A5.3.8, A5.3.9): a preload or, of a halfword, an
/// unallocated hint.
std::string preload_text(const DecodedOp& op) {
  switch (line_of(op).operation) {
    case Operation::ldrb:
      return "pld " + address_text(op);
    case Operation::ldrsb:
      return "pli " + address_text(op);
    default:
      return "nop";
  }
}

/// The text of an instruction without its condition.
std::string unconditional_text(const DecodedOp& op) {
  if (op.operation == Operation::nop && line_of(op).operation != Operation::nop)
    return preload_text(op);
  std::string text;
  for (const char* p = line_of(op).assembly; *p != 0; ++p) {
    if (*p != '{') {
      text += *p;
      continue;
    }
    std::string field;
    while (*++p != '}') field += *p;
    text += field_text(field, op);
  }
  return text;
}

}  // namespace

std::string disassemble(const DecodedOp& op) {
  const Encoding* line = find_encoding(op.encoding, op.size);
  const bool named = line != nullptr && line->operation == Operation::undefined;
  if (op.operation == Operation::undefined && !named) return "undefined " + hex(op.encoding);
  std::string text = unconditional_text(op);
  if (op.condition == condition_always) return text;
  std::size_t end = text.find_first_of(" .");
  return text.insert(end == std::string::npos ? text.size() : end, condition_name(op.condition));
}

}  // namespace capsoc::armv7m
