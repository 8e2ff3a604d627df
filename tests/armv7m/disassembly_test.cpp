// The disassembler against libcapstone: every 16-bit encoding, and random operands through every
// 32-bit line of isa.def. Spelling is made alike first (numbers, register names, the .w suffix).
#include <capstone/capstone.h>
#include <gtest/gtest.h>

#include <cctype>
#include <cstdio>
#include <map>
#include <random>
#include <string>

#include "armv7m/isa/decoder.h"
#include "oracle_policy.h"

namespace capsoc::armv7m::test {
namespace {

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

/// Numbers in decimal and without a sign, r9 to r12 by number, no ".w", no "#" and no blank ends.
std::string alike(const std::string& text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size();) {
    const bool boundary = i == 0 || std::isalnum(static_cast<unsigned char>(text[i - 1])) == 0;
    const std::size_t digit = text[i] == '-' ? i + 1 : i;
    if (boundary && digit < text.size() && std::isdigit(static_cast<unsigned char>(text[digit]))) {
      std::size_t used = 0;
      plain += std::to_string(static_cast<uint32_t>(std::stoll(text.substr(i), &used, 0)));
      i += used;
    } else {
      if (text[i] != '#') plain += text[i];
      ++i;
    }
  }
  replace_all(plain, ".w", "");
  replace_all(plain, ", 0]", "]");
  for (const auto& [name, number] :
       {std::pair{"sb", "r9"}, {"sl", "r10"}, {"fp", "r11"}, {"ip", "r12"}}) {
    for (const char* before : {" ", "[", "{"}) {
      for (const char* after : {",", "]", "}", "!", "\n"})
        replace_all(plain += after[0] == '\n' ? "\n" : "", std::string(before) + name + after,
                    std::string(before) + number + after);
      while (!plain.empty() && plain.back() == '\n') plain.pop_back();
    }
  }
  while (!plain.empty() && plain.back() == ' ') plain.pop_back();
  return plain;
}

/// Encodings left out, each with its reason.
bool spelled_otherwise(const Encoding& e, const DecodedOp& op) {
  const std::string name = e.name;
  // The preferred text of ADR relative to the PC; libcapstone writes SUBW and ADDW of the PC.
  if (name == "adr_t2" || name == "adr_t3") return true;
  // It names operands and systems; here all coprocessor instructions are one that faults.
  if (op.operation == Operation::coprocessor) return true;
  // What is undefined here alone: double precision, and the like.
  if (op.operation == Operation::fp_undefined) return true;
  // "add r0, sp, r0" there, "add r0, sp" here: both are assembled to it.
  if (name == "add_reg_t2" && op.rm == 13) return true;
  // It knows one number of UDF as an operating system's trap.
  if (name == "udf_t1" && op.imm == 254) return true;
  // Since version 5 it has names of Armv8: DFB for DSB 12, ESB and CSDB for the hints 16 and 20.
  if (CS_API_MAJOR > 4 && name == "dsb_t1" && op.imm == 12) return true;
  if (CS_API_MAJOR > 4 && name == "nop_t2" && (op.imm == 16 || op.imm == 20)) return true;
  // PLDW, of the multiprocessing extension, which ARMv7-M does not have (A5.3.9).
  if (op.operation == Operation::nop && e.operation == Operation::ldrh) return true;
  // What the line does not have on this processor: HVC and the like.
  return op.operation == Operation::undefined && e.operation != Operation::undefined;
}

class Disassembly : public ::testing::Test {
 protected:
  csh handle = 0;
  std::map<std::string, std::string> differences;
  unsigned compared = 0;
  std::map<std::string, unsigned> unknown;  // encodings of a line

  void SetUp() override {
    ASSERT_EQ(cs_open(CS_ARCH_ARM, static_cast<cs_mode>(CS_MODE_THUMB | CS_MODE_MCLASS), &handle),
              CS_ERR_OK);
  }
  void TearDown() override {
    cs_close(&handle);
    std::printf("disassembly: %u encodings compared; libcapstone does not know:", compared);
    for (const auto& u : unknown) std::printf(" %s (%u)", u.first.c_str(), u.second);
    std::printf("\n");
    for (const auto& d : differences) ADD_FAILURE() << d.first << ": " << d.second;
  }
  void compare(const Encoding& e, uint32_t bits) {
    constexpr uint32_t at = 0x1000;
    const bool wide = e.length == 32;
    const auto first = static_cast<uint16_t>(wide ? bits >> 16 : bits);
    const auto second = static_cast<uint16_t>(bits);
    const DecodedOp op = decode(at, first, second, 0, cortex_m4f);
    if (unpredictable(op) || spelled_otherwise(e, op)) return;
    const uint8_t bytes[4] = {static_cast<uint8_t>(first), static_cast<uint8_t>(first >> 8),
                              static_cast<uint8_t>(second), static_cast<uint8_t>(second >> 8)};
    cs_insn* insn = nullptr;
    if (cs_disasm(handle, bytes, wide ? 4 : 2, at, 1, &insn) == 0) {
      ++unknown[e.name];
      return;
    }
    const std::string theirs =
        alike(std::string(insn->mnemonic) + (*insn->op_str != 0 ? " " : "") + insn->op_str);
    cs_free(insn, 1);
    const std::string ours = alike(disassemble(op));
    ++compared;
    if (ours != theirs) differences.emplace(e.name, ours + " is " + theirs + " to libcapstone");
  }
};

TEST_F(Disassembly, EverySixteenBitEncodingReadsAsLibcapstoneReadsIt) {
  for (uint32_t h = 0; h < 0xE800; ++h) {
    const Encoding* e = find_encoding(h, 2);
    if (e != nullptr) compare(*e, h);
  }
}

TEST_F(Disassembly, EveryThirtyTwoBitLineReadsAsLibcapstoneReadsIt) {
  std::mt19937 random(1);
  for (unsigned i = 0; i < encoding_count(); ++i) {
    const Encoding& e = encodings()[i];
    if (e.length != 32) continue;
    for (unsigned k = 0; k < 400; ++k) {
      const uint32_t bits = with_should_be_bits(e, (random() & ~e.mask) | e.value);
      if (find_encoding(bits, 4) == &e) compare(e, bits);
    }
  }
}

// B5.2.2, B5.2.3: every special register there is, and each mask of MSR that ARMv7-M allows.
TEST_F(Disassembly, EverySpecialRegisterReadsAsLibcapstoneReadsIt) {
  for (uint32_t special = 0; special < 21; ++special) {
    for (uint32_t reg = 0; reg < 13; ++reg) {
      for (const uint32_t bits :
           {0xF3EF8000u | reg << 8 | special, 0xF3808800u | reg << 16 | special})
        compare(*find_encoding(bits, 4), bits);
    }
  }
  EXPECT_EQ(compared, 2u * 13 * 14);
}

}  // namespace
}  // namespace capsoc::armv7m::test
