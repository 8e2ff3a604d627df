#include "armv7m/isa/decoder.h"

#include <algorithm>
#include <array>

#include "armv7m/isa/alu.h"
#include "armv7m/isa/single_precision.h"

namespace capsoc::armv7m {
namespace {

constexpr Encoding parse(const char* name, uint8_t set, const char* pattern, Operation operation,
                         Form form, FlagRule flags, CycleClass cycle_class, const char* assembly) {
  Encoding e{name, set, pattern, operation, form, flags, cycle_class, assembly, 0,
             0,    0,   0,       0,         0,    0};
  for (const char* p = pattern; *p != 0; ++p, ++e.length) {
    bool fixed = *p == '0' || *p == '1';
    e.mask = e.mask << 1 | (fixed ? 1u : 0u);
    e.value = e.value << 1 | (*p == '1' ? 1u : 0u);
    e.ones = e.ones << 1 | (*p == 'o' ? 1u : 0u);
    e.zeros = e.zeros << 1 | (*p == 'z' ? 1u : 0u);
    if (fixed) {
      ++e.fixed_bits;
    } else {
      e.letters |= 1u << (*p - 'a');
    }
  }
  return e;
}

constexpr Encoding table[] = {
#define ENCODING(name, set, pattern, operation, form, flags, cycles, assembly)                   \
  parse(#name, instruction_set::set, pattern, Operation::operation, Form::form, FlagRule::flags, \
        CycleClass::cycles, assembly),
#include "armv7m/isa/isa.def"
#undef ENCODING
};
constexpr unsigned table_size = sizeof(table) / sizeof(table[0]);

constexpr bool lengths_are_legal() {
  for (const Encoding& e : table) {
    if (e.length != 16 && e.length != 32) return false;
  }
  return true;
}
static_assert(lengths_are_legal(), "a bit pattern of isa.def has neither 16 nor 32 bits");

/// Which line is meant where several match: a literal load is one whatever its offset looks like.
constexpr unsigned precedence(const Encoding& e) {
  return e.fixed_bits + (e.form == Form::load_lit ? 32u : 0u);
}

/// The lines, those that are meant before those that match as well.
constexpr std::array<int16_t, table_size> by_precedence() {
  std::array<int16_t, table_size> order{};
  for (unsigned count = 0; count < table_size; ++count) {
    unsigned place = count;
    for (; place > 0 && precedence(table[order[place - 1]]) < precedence(table[count]); --place)
      order[place] = order[place - 1];
    order[place] = static_cast<int16_t>(count);
  }
  return order;
}

constexpr unsigned bucket_count = 512;
constexpr uint32_t bucket_bits = 0x1FF00000u;

/// How many buckets the 32-bit lines are in, altogether.
constexpr unsigned count_wide() {
  unsigned count = 0;
  for (const Encoding& e : table) {
    if (e.length != 32) continue;
    unsigned buckets = bucket_count;
    for (uint32_t fixed = e.mask & bucket_bits; fixed != 0; fixed &= fixed - 1) buckets /= 2;
    count += buckets;
  }
  return count;
}

/// 16-bit encodings by their value; 32-bit ones in buckets of bits 28..20, most fixed bits first.
struct Lookup {
  std::array<int16_t, 65536> narrow{};
  std::array<uint16_t, bucket_count + 1> begins{};  ///< of the buckets, in `wide`
  std::array<int16_t, count_wide()> wide{};

  constexpr Lookup() {
    for (int16_t& place : narrow) place = -1;
    const std::array<int16_t, table_size> order = by_precedence();
    for (const int16_t i : order)
      if (table[i].length == 16) add_narrow(i);
    unsigned end = 0;
    for (uint32_t bucket = 0; bucket < bucket_count; ++bucket) {
      for (const int16_t i : order) {
        const Encoding& e = table[i];
        if (e.length == 32 && ((bucket << 20 ^ e.value) & e.mask & bucket_bits) == 0)
          wide[end++] = i;
      }
      begins[bucket + 1] = static_cast<uint16_t>(end);
    }
  }
  constexpr void add_narrow(int16_t index) {
    const Encoding& e = table[index];
    const uint32_t fields = ~e.mask & 0xFFFF;
    uint32_t bits = 0;  // each value of the fields in turn
    do {
      int16_t& place = narrow[e.value | bits];
      if (place < 0) place = index;
      bits = (bits - fields) & fields;
    } while (bits != 0);
  }
};

// The compiler makes it: a program would take as long as a short run does. Not `constexpr`, which
// is an error where a compiler has less patience.
const Lookup lookup;

/// The bits of each letter of a pattern, concatenated.
struct Fields {
  std::array<uint32_t, 26> value{};
  std::array<bool, 26> present{};

  Fields(const Encoding& e, uint32_t bits) {
    for (unsigned k = 0; k < e.length; ++k) {
      char c = e.pattern[k];
      if (c < 'a') continue;
      unsigned letter = static_cast<unsigned>(c - 'a');
      value[letter] = value[letter] << 1 | ((bits >> (e.length - 1 - k)) & 1);
      present[letter] = true;
    }
  }
  uint32_t operator[](char c) const { return value[static_cast<unsigned>(c - 'a')]; }
  bool has(char c) const { return present[static_cast<unsigned>(c - 'a')]; }
};

void set_undefined(DecodedOp& op) {
  op.operation = Operation::undefined;
}

bool is_sub_word_load(Operation o) {
  return o == Operation::ldrb || o == Operation::ldrh || o == Operation::ldrsb ||
         o == Operation::ldrsh;
}

/// Single transfers. A load of less than a word to R15 is a preload or an unallocated hint (A5.3.8,
/// A5.3.9), a literal base is the aligned PC, a store relative to the PC is undefined.
void resolve_transfer(DecodedOp& op, const Fields& f, Form form) {
  const bool store = form >= Form::store12 && form <= Form::store_user;
  switch (form) {
    case Form::store12:
    case Form::load12:
      op.imm = f['i'];
      break;
    case Form::store_index:
    case Form::load_index:
      op.addressing = Addressing::reg;
      op.shift.amount = static_cast<uint8_t>(f['i']);
      break;
    case Form::store_user:
    case Form::load_user:
      op.addressing = Addressing::unprivileged;
      break;
    case Form::load_lit:
      op.imm = f['u'] ? f['i'] : 0u - f['i'];
      op.addressing = Addressing::literal;
      break;
    default:
      op.imm = f['u'] ? f['i'] : 0u - f['i'];
      if (!f['p'] && !f['w']) return set_undefined(op);
      op.writeback = f['w'] != 0;
      if (op.writeback) op.addressing = f['p'] ? Addressing::pre_indexed : Addressing::post_indexed;
  }
  if (store && op.rn == 15) return set_undefined(op);
  if (op.rd == 15 && is_sub_word_load(op.operation)) op.operation = Operation::nop;
}

uint32_t wide_branch_offset(uint32_t bits, Form form) {
  uint32_t s = (bits >> 26) & 1, j1 = (bits >> 13) & 1, j2 = (bits >> 11) & 1;
  uint32_t low = (bits & 0x7FF) << 1;
  if (form == Form::branch20) {
    return sign_extend(s << 20 | j2 << 19 | j1 << 18 | ((bits >> 16) & 0x3F) << 12 | low, 21);
  }
  uint32_t i1 = (j1 ^ s) ^ 1, i2 = (j2 ^ s) ^ 1;
  return sign_extend(s << 24 | i1 << 23 | i2 << 22 | ((bits >> 16) & 0x3FF) << 12 | low, 25);
}

/// A field's letters: i is its lsb, b its width - 1 or its msb.
void resolve_field(DecodedOp& op, const Fields& f, Form form) {
  const unsigned last = form == Form::extract ? f['i'] + f['b'] : f['b'];
  const int width = static_cast<int>(last) - static_cast<int>(f['i']) + 1;
  op.field = {static_cast<uint8_t>(f['i']), static_cast<int8_t>(width)};
}

/// Fraction bits of a fixed-point number: its width less i, whose lowest bit is the first in the
/// pattern. b: 32 bits.
void resolve_fraction(DecodedOp& op, const Fields& f) {
  const uint32_t width = f['b'] != 0 ? 32 : 16, less = (f['i'] & 15) << 1 | f['i'] >> 4;
  op.imm = less <= width ? width - less : 0;
}

void resolve(DecodedOp& op, const Fields& f, Form form) {
  switch (form) {
    case Form::none:
    case Form::system:
      break;
    case Form::plain:
    case Form::it:
      break;
    case Form::plain_x2:
      op.imm = f['i'] << 1;
      break;
    case Form::plain_x4:
      op.imm = f['i'] << 2;
      break;
    case Form::negative:
      op.imm = 0u - f['i'];
      break;
    case Form::modified: {
      ImmediateResult r = thumb_expand_imm_c(f['i']);
      op.imm = r.value;
      op.carry_from_imm = r.rotated;
      break;
    }
    case Form::shift:
      op.shift = decode_imm_shift(f['y'], f['i']);
      break;
    case Form::shift_lsl:
      op.shift = decode_imm_shift(0, f['i']);
      break;
    case Form::shift_lsr:
      op.shift = decode_imm_shift(1, f['i']);
      break;
    case Form::shift_asr:
      op.shift = decode_imm_shift(2, f['i']);
      break;
    case Form::saturate:
      // ASR #0 is SSAT16 or USAT16, in other lines.
      if (f['y'] && f['i'] == 0) return set_undefined(op);
      op.shift = decode_imm_shift(f['y'] ? 2 : 0, f['i']);
      op.field.width = static_cast<int8_t>(f['b'] + (op.operation == Operation::ssat ? 1 : 0));
      break;
    case Form::saturate16:
      op.field.width = static_cast<int8_t>(f['b'] + (op.operation == Operation::ssat16 ? 1 : 0));
      break;
    case Form::extract:
    case Form::insert:
      resolve_field(op, f, form);
      break;
    case Form::rotate:
      op.shift.amount = static_cast<uint8_t>(f['i'] * 8);
      break;
    case Form::literal_x4:
      op.imm = f['i'] << 2;
      op.addressing = Addressing::literal;
      break;
    case Form::index:
      op.addressing = Addressing::reg;
      break;
    case Form::sp_sp_x4:
      op.rd = 13;
      [[fallthrough]];
    case Form::sp_x4:
      op.rn = 13;
      op.imm = f['i'] << 2;
      break;
    case Form::push:
    case Form::pop:
      op.rn = 13;
      op.writeback = true;
      // Eight low registers, and one more: LR, or PC.
      op.list.bits =
          static_cast<uint16_t>((f['l'] & 0xFF) | (f['l'] >> 8) << (form == Form::push ? 14 : 15));
      break;
    case Form::list:
      op.writeback = f['w'] != 0;
      break;
    case Form::list_sp:
      op.rn = 13;
      [[fallthrough]];
    case Form::list_wb:
      op.writeback = true;
      break;
    case Form::list_load:
      op.writeback = !op.list.has(op.rn);
      break;
    case Form::dual:
      op.imm = (f['u'] ? f['i'] : 0u - f['i']) * 4;
      if (!f['p'] && !f['w']) return set_undefined(op);
      op.writeback = f['w'] != 0;
      if (op.writeback) op.addressing = f['p'] ? Addressing::pre_indexed : Addressing::post_indexed;
      if (op.rn == 15) op.addressing = Addressing::literal;
      break;
    case Form::fp_immediate:
      op.imm = single::expand_immediate(f['i']);
      break;
    case Form::fp_fixed:
      resolve_fraction(op, f);
      break;
    case Form::fp_offset:
      op.imm = (f['u'] ? f['i'] : 0u - f['i']) * 4;
      if (op.rn == 15) op.addressing = Addressing::literal;
      break;
    case Form::fp_list:
      op.imm = f['i'] * 4;
      op.writeback = !f.has('w') || f['w'] != 0;
      if (!f.has('n')) op.rn = 13;
      break;
    case Form::branch8:
      op.imm = sign_extend(f['i'] << 1, 9);
      break;
    case Form::branch11:
      op.imm = sign_extend(f['i'] << 1, 12);
      break;
    case Form::branch20:
      if (f['c'] >= 14) return set_undefined(op);
      [[fallthrough]];
    case Form::branch24:
      op.imm = wide_branch_offset(op.encoding, form);
      break;
    default:
      resolve_transfer(op, f, form);
  }
}

/// 16-bit moves of two plain registers need none of the care that SP and PC ask for.
void simplify(DecodedOp& op) {
  auto plain = [](uint8_t r) { return r != 13 && r != 15; };
  if (op.operation == Operation::mov_high && plain(op.rd) && plain(op.rm)) {
    op.operation = Operation::mov_reg;
  } else if (op.operation == Operation::add_high && plain(op.rd) && op.rm != 15) {
    op.operation = Operation::add_reg;
  } else if (op.operation == Operation::cmp_high && op.rn != 15 && op.rm != 15) {
    op.operation = Operation::cmp_reg;
  }
}

uint8_t static_cycles(const DecodedOp& op, CycleClass kind, const Timing& timing) {
  unsigned n = timing.of(kind);
  if (kind == CycleClass::multiple) n += op.list.count();
  if (is(op, kind::fp_multiple)) n += std::min(op.imm / 4, fp_operand::registers);
  return static_cast<uint8_t>(n);
}

uint8_t flags_set(FlagRule rule, const Fields& f, uint8_t it_state) {
  switch (rule) {
    case FlagRule::always:
      return 1;
    case FlagRule::it:
      return (it_state & 0xF) == 0;
    case FlagRule::s:
      return f['s'] != 0;
    default:
      return 0;
  }
}

/// What an instruction names and the core does not have.
void leave_out(DecodedOp& op, const Profile& profile) {
  constexpr uint32_t faultmask_of_cps = 1;
  const bool names_one = op.operation == Operation::mrs || op.operation == Operation::msr;
  const uint32_t named = op.encoding & 0xFF;
  if (names_one) op.unallocated = !profile.has_special(named);
  constexpr uint32_t mask_g = 1u << 10, last_with_flags = 3;
  if (op.operation == Operation::msr && named <= last_with_flags)
    op.sets_ge = (op.encoding & mask_g) != 0 && profile.has_dsp();
  if (op.operation == Operation::cps && !profile.has_special(special::faultmask))
    op.imm &= ~faultmask_of_cps;
}

}  // namespace

const Encoding* encodings() {
  return table;
}
unsigned encoding_count() {
  return table_size;
}

const Encoding* find_encoding(uint32_t encoding, unsigned size, uint8_t sets) {
  if (size == 2) {
    int16_t index = lookup.narrow[encoding & 0xFFFF];
    return index < 0 || (table[index].set & sets) == 0 ? nullptr : &table[index];
  }
  const unsigned bucket = (encoding & bucket_bits) >> 20;
  for (unsigned i = lookup.begins[bucket]; i < lookup.begins[bucket + 1]; ++i) {
    const Encoding& e = table[lookup.wide[i]];
    if ((encoding & e.mask) == e.value && (e.set & sets) != 0) return &e;
  }
  return nullptr;
}

const Encoding& line_of(const DecodedOp& op) {
  return table[op.row];
}

DecodedOp decode(uint32_t address, uint16_t first, uint16_t second, uint8_t it_state,
                 const Profile& profile) {
  DecodedOp op;
  op.address = address;
  op.size = is_wide(first) ? 4 : 2;
  op.encoding = op.size == 4 ? static_cast<uint32_t>(first) << 16 | second : first;
  op.refills_late = profile.timing.three_stages && op.size == 4 && (address & 2) != 0;
  op.it_before = it_state;
  op.it_after = it_advance(it_state);
  if ((it_state & 0xF) != 0) op.condition = it_state >> 4;
  if (op.condition == 15) op.condition = condition_always;
  op.operation = Operation::undefined;
  op.cycles = 1;
  const Encoding* e = find_encoding(op.encoding, op.size, profile.instruction_sets);
  if (e == nullptr) return op;
  op.row = static_cast<uint16_t>(e - table);
  Fields f(*e, op.encoding);
  op.operation = e->operation;
  op.rd = static_cast<uint8_t>(f.has('e') ? f['e'] : f['d']);
  op.rn = static_cast<uint8_t>(f.has('e') ? f['e'] : f['n']);
  op.list.bits = static_cast<uint16_t>(f['l']);
  op.rm = static_cast<uint8_t>(f['m']);
  op.ra = static_cast<uint8_t>(f['a']);
  op.imm = f['i'] | (f.has('j') ? f['j'] << 12 : 0);
  op.set_flags = flags_set(e->flags, f, it_state) != 0;
  resolve(op, f, e->form);
  if (e->form == Form::it) op.it_after = static_cast<uint8_t>(op.imm);
  simplify(op);
  leave_out(op, profile);
  op.by_operands = profile.timing.long_multiply_by_operands && is(op, kind::long_multiply);
  op.cycles = static_cycles(op, e->cycle_class, profile.timing);
  return op;
}

uint32_t written_by(const DecodedOp& op) {
  const auto bit = [](unsigned n) { return n < 16 ? 1u << n : 0u; };
  const bool indexed = op.writeback || op.addressing == Addressing::pre_indexed ||
                       op.addressing == Addressing::post_indexed;
  if (is(op, kind::transfer)) {
    uint32_t set = indexed ? bit(op.rn) : 0;
    if (is(op, kind::load | kind::dual_load | kind::exclusive_load)) set |= bit(op.rd);
    if (is(op, kind::dual_load | kind::exclusive_store)) set |= bit(op.ra);
    if (is(op, kind::multiple_load)) set |= op.list.bits;
    return set;
  }
  if (is(op, kind::fp_transfer)) return op.writeback ? bit(op.rn) : 0;
  if (op.operation == Operation::vmov_pair_to_core) return bit(op.rd) | bit(op.ra);
  // VMRS with R15 writes the flags.
  const bool to_core = op.operation == Operation::vmov_to_core || op.operation == Operation::vmrs;
  if (is(op, kind::fp_extension)) return to_core && op.rd != 15 ? bit(op.rd) : 0;
  if (op.operation == Operation::bl || op.operation == Operation::blx) return bit(14);
  if (is(op, kind::compare | kind::any_branch | kind::none)) return 0;
  if (is(op, kind::system)) return op.operation == Operation::mrs ? bit(op.rd) : 0;
  return bit(op.rd) | (is(op, kind::two_results) ? bit(op.ra) : 0);
}

bool ends_block(const DecodedOp& op) {
  if (traits(op.operation).ends_block) return true;
  switch (op.operation) {
    case Operation::ldr:
      return op.rd == 15;
    case Operation::ldm:
    case Operation::ldmdb:
      return op.list.has(15);
    case Operation::mov_high:
    case Operation::add_high:
      return op.rd == 15;
    default:
      return false;
  }
}

}  // namespace capsoc::armv7m
