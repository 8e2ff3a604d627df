#pragma once

#include <cstdint>
#include <string>

#include "armv7m/isa/op.h"
#include "armv7m/isa/timing.h"
#include "armv7m/profile.h"

namespace capsoc::armv7m {

/// How the letters of a pattern become operands; named in isa.def.
enum class Form : uint8_t {
  none,
  plain,
  plain_x2,
  plain_x4,
  negative,
  modified,
  shift,
  shift_lsl,
  shift_lsr,
  shift_asr,
  rotate,
  extract,
  insert,
  saturate,
  saturate16,
  literal_x4,
  index,
  sp_x4,
  sp_sp_x4,
  push,
  pop,
  list,
  list_wb,
  list_load,
  list_sp,
  dual,
  store12,
  store8,
  store_index,
  store_user,
  load12,
  load8,
  load_index,
  load_user,
  load_lit,
  branch8,
  branch11,
  branch20,
  branch24,
  it,
  system,
  fp_immediate,
  fp_fixed,
  fp_offset,
  fp_list
};
enum class FlagRule : uint8_t { never, always, it, s };

/// One line of isa.def, its pattern parsed.
struct Encoding {
  const char* name;
  uint8_t set;  ///< instruction_set::Set
  const char* pattern;
  Operation operation;
  Form form;
  FlagRule flags;
  CycleClass cycle_class;
  const char* assembly;
  uint32_t mask;         // the fixed bits, 16-bit encodings in the low half
  uint32_t value;        // what they must be
  uint32_t ones, zeros;  // bits that should be one, and zero
  uint32_t letters;      // bit n: the pattern has the n-th letter
  uint8_t length;        // 16 or 32
  uint8_t fixed_bits;

  bool has(char letter) const { return ((letters >> (letter - 'a')) & 1) != 0; }
};

const Encoding* encodings();
unsigned encoding_count();

/// The line that `encoding` means (first halfword in the upper half if 32-bit), or null. `sets`:
/// among lines of these sets (instruction_set::Set).
const Encoding* find_encoding(uint32_t encoding, unsigned size,
                              uint8_t sets = instruction_set::all);

/// True when a first halfword opens a 32-bit instruction (A5.1).
constexpr bool is_wide(uint32_t halfword) {
  return (halfword >> 11) >= 0x1D;
}

/// ITAdvance (A7.3.3).
constexpr uint8_t it_advance(uint8_t it) {
  return (it & 7) == 0 ? 0 : static_cast<uint8_t>((it & 0xE0) | ((it << 1) & 0x1F));
}

/// The line that an instruction was decoded by; not for Operation::undefined.
const Encoding& line_of(const DecodedOp& op);

/// Decodes any 16 or 32 bits; what is no instruction of the profile becomes Operation::undefined.
DecodedOp decode(uint32_t address, uint16_t first, uint16_t second, uint8_t it_state,
                 const Profile& profile = cortex_m3);

/// Assembly text of a decoded instruction, for traces and reports.
std::string disassemble(const DecodedOp& op);

}  // namespace capsoc::armv7m
