#include "armv7m/executors/translator/flag_tracker.h"

#include <cstring>

#include "armv7m/isa/decoder.h"
#include "armv7m/machine.h"

namespace capsoc::armv7m {

using namespace asmjit;
using Of = FlagSource::Of;

void FlagTracker::begin_block() {
  serial_ = 0;
  host_serial_ = 0;
  flags_ = {};
  flags_.nz.of = flags_.c.of = flags_.v.of = Of::inherited;
}

void FlagTracker::begin_step(uint32_t written, uint8_t killed, uint8_t visible) {
  protect(written, killed, visible);
  ++serial_;
  host_kept_ = false;
}

void FlagTracker::end_step() {
  if (host_serial_ != serial_ && !host_kept_) host_serial_ = 0;
  forget_host_carries();
}

void FlagTracker::restore(const Snapshot& snapshot) {
  flags_ = snapshot.sources;
  host_serial_ = snapshot.host_serial;
  host_flags_ = snapshot.host_flags;
}

void FlagTracker::set_sources(uint8_t which, FlagSource source) {
  source.serial = serial_;
  if (which & flag::nz) flags_.nz = source;
  if (which & flag::c) flags_.c = source;
  if (which & flag::v) flags_.v = source;
}

void FlagTracker::in_host(HostFlags which) {
  host_serial_ = serial_;
  host_flags_ = which;
}

bool FlagTracker::host_has(const FlagSource& source, HostFlags least) const {
  if (host_serial_ == 0 || source.serial != host_serial_) return false;
  return least == HostFlags::nz || host_flags_ != HostFlags::nz;
}

void FlagTracker::protect(uint32_t written, uint8_t killed, uint8_t visible) {
  uint8_t lost = 0;
  if ((flags_.nz.registers() & written) != 0) lost |= flag::nz;
  if ((flags_.c.registers() & written) != 0) lost |= flag::c;
  if ((flags_.v.registers() & written) != 0) lost |= flag::v;
  lost &= static_cast<uint8_t>(~killed & visible);
  if (lost == 0) return;
  const std::array<unsigned, 2> words = free_words();
  if (!die_in_block(lost) || !put_aside(lost, written, words.data(), words.size())) settle(lost);
}

/// True if the block sets these flags before it ends: only a way out on the way there can see them.
bool FlagTracker::die_in_block(uint8_t which) const {
  for (std::size_t i = plan_.present(); i < plan_.cut(); ++i) {
    which &= static_cast<uint8_t>(~flag_use(plan_[i]).kills);
    if (which == 0) return true;
  }
  return false;
}

bool FlagTracker::only_next_reads(uint8_t which) const {
  const std::size_t at = plan_.present() + 1;
  if (at >= plan_.cut() || plan_[plan_.present()].condition != condition_always) return false;
  const Step& next = plan_[at];
  if (next.condition != condition_always || may_be_left_at(next)) return false;
  if (next.operation == Operation::it) {
    const std::size_t group = at + 1;
    if (group >= plan_.cut() || plan_[group].condition >= condition_always) return false;
    return (plan_.visible_behind_group(group, plan_.end_of_group(group)) & which) == 0;
  }
  const bool takes = traits(next.operation).flags == FlagEffect::with_carry ||
                     (next.shift.type == ShiftType::rrx && is(next, kind::data));
  return takes && (plan_.visible(at) & ~flag_use(next).kills & which) == 0;
}

/// Drops carries that were only in the host's flags and are overwritten there: they were dead.
void FlagTracker::forget_host_carries() {
  for (FlagSource* source : {&flags_.c, &flags_.v})
    if (source->of == Of::host && source->serial != host_serial_) *source = {};
}

/// Words that none of the flags is made from: three flags of two operands leave as many.
std::array<unsigned, 2> FlagTracker::free_words() const {
  std::array<unsigned, 2> free{};
  std::size_t found = 0;
  const uint32_t used = flags_.registers() >> FlagOperand::first_aside;
  for (unsigned n = 0; n < words_aside - words_left && found < free.size(); ++n)
    if ((used >> n & 1) == 0) free[found++] = n;
  return free;
}

/// Keeps the operands of flags that are made from `registers` in the words numbered so, and makes
/// the flags from these; the host's flags stay. False, and nothing done: they are too many or take
/// computing.
bool FlagTracker::put_aside(uint8_t which, uint32_t registers, const unsigned* words,
                            std::size_t count) {
  std::array<FlagOperand, 6> kept;
  std::size_t found = 0;
  FlagSources sources = flags_;
  const auto keep = [&](FlagOperand& operand) {
    if ((operand.registers() & registers) == 0) return true;
    const bool plain = operand.plus == FlagOperand::none && operand.minus == FlagOperand::none;
    if (!plain) return false;
    std::size_t i = 0;
    while (i < found && !(kept[i] == operand)) ++i;
    if (i == count) return false;
    if (i == found) kept[found++] = operand;
    operand = FlagOperand::aside(words[i]);
    return true;
  };
  for (const auto& [bit, source] : {std::pair{flag::nz, &sources.nz},
                                    std::pair{flag::c, &sources.c}, std::pair{flag::v, &sources.v}})
    if ((which & bit) != 0 && source->pending() && !(keep(source->x) && keep(source->y)))
      return false;
  for (std::size_t i = 0; i < found; ++i) {
    Gp value = registers_.read(kept[i].base, x86::eax);
    if (kept[i].imm != 0) {
      a_.lea(x86::eax, sum_of(value, static_cast<int32_t>(kept[i].imm)));
      value = x86::eax;
    }
    a_.mov(registers_.in_state(FlagOperand::first_aside + words[i]), value);
  }
  flags_ = sources;
  return true;
}

FlagOperand FlagTracker::aside(const Gp& value) {
  const FlagOperand operand = FlagOperand::aside(free_words()[0]);
  a_.mov(registers_.in_state(operand.base), value);
  return operand;
}

void FlagTracker::operand_to(const Gp& to, const FlagOperand& operand) {
  if (operand.base == FlagOperand::none) {
    a_.mov(to, operand.imm);
  } else {
    registers_.read_to(to, operand.base);
    if (operand.imm != 0) a_.add(to, operand.imm);
  }
  if (operand.plus != FlagOperand::none)
    a_.emit(x86::Inst::kIdAdd, to, registers_.at(operand.plus));
  if (operand.minus != FlagOperand::none)
    a_.emit(x86::Inst::kIdSub, to, registers_.at(operand.minus));
}

/// A register or a number as an operand of the host; others are computed first.
Operand FlagTracker::simple_operand(const FlagOperand& operand, const Gp& scratch) {
  if (operand.is_register()) return registers_.at(operand.base);
  if (operand.is_number()) return Imm(static_cast<int32_t>(operand.imm));
  operand_to(scratch, operand);
  return scratch;
}

namespace {

x86::Inst::Id instruction_of(Of of) {
  switch (of) {
    case Of::both:
      return x86::Inst::kIdAnd;
    case Of::either:
      return x86::Inst::kIdXor;
    case Of::sum:
      return x86::Inst::kIdAdd;
    default:
      return x86::Inst::kIdSub;
  }
}

}  // namespace

/// The result of a pending operation, and its flags as the host's.
void FlagTracker::compute(const FlagSource& source, const Gp& result) {
  const Operand y = source.of == Of::value ? Operand(Imm(0)) : simple_operand(source.y, x86::ecx);
  operand_to(result, source.x);
  host_serial_ = source.serial;
  host_flags_ = source.of == Of::difference ? HostFlags::difference
                : source.of == Of::sum      ? HostFlags::sum
                                            : HostFlags::nz;
  if (source.of == Of::value)
    a_.test(result, result);
  else
    a_.emit(instruction_of(source.of), result, y);
}

/// The flags of a pending operation as the host's.
void FlagTracker::compare(const FlagSource& source) {
  const bool plain = source.x.is_register() && pinned(source.x.base);
  if (plain && source.of == Of::value) {
    a_.test(host_register(source.x.base), host_register(source.x.base));
    host_flags_ = HostFlags::nz;
  } else if (plain && (source.of == Of::difference || source.of == Of::both)) {
    const bool difference = source.of == Of::difference;
    Operand y = simple_operand(source.y, x86::ecx);
    if (difference)
      a_.emit(x86::Inst::kIdCmp, host_register(source.x.base), y);
    else if (y.isMem())
      a_.emit(x86::Inst::kIdTest, y, host_register(source.x.base));
    else
      a_.emit(x86::Inst::kIdTest, host_register(source.x.base), y);
    host_flags_ = difference ? HostFlags::difference : HostFlags::nz;
  } else {
    compute(source, x86::eax);
  }
  host_serial_ = source.serial;
}

void FlagTracker::store_nz(const Gp& value) {
  a_.mov(code_.state_word(&machine_.state.n), value);
  a_.mov(code_.state_word(&machine_.state.z), value);
}

void FlagTracker::carry_to_host(bool borrow) {
  const FlagSource& c = flags_.c;
  if (!host_has(c, HostFlags::sum)) {
    if (c.of == Of::difference || c.of == Of::sum) {
      compare(c);
    } else {
      a_.cmp(code_.state_byte(&machine_.state.c), 1);  // CF is C's inverse
      if (!borrow) a_.cmc();
      return;
    }
  }
  if ((host_flags_ == HostFlags::difference) != borrow) a_.cmc();
}

/// C and V from the host's flags, which are those of their operation.
void FlagTracker::settle_carries(uint8_t which) {
  const bool borrow = host_flags_ == HostFlags::difference;
  if (which & flag::c) {
    const Mem c = code_.state_byte(&machine_.state.c);
    if (borrow)
      a_.setae(c);
    else
      a_.setc(c);
    flags_.c = {Of::memory, {}, {}, flags_.c.serial};
  }
  if (which & flag::v) {
    a_.seto(code_.state_byte(&machine_.state.v));
    flags_.v = {Of::memory, {}, {}, flags_.v.serial};
  }
}

void FlagTracker::settle(uint8_t which) {
  const auto unsettled = [](const FlagSource& s) { return s.of > Of::inherited; };
  if (!unsettled(flags_.nz)) which &= static_cast<uint8_t>(~flag::nz);
  if (!unsettled(flags_.c)) which &= static_cast<uint8_t>(~flag::c);
  if (!unsettled(flags_.v)) which &= static_cast<uint8_t>(~flag::v);
  // Those that only the host has come first: computing others changes them.
  if (which != 0 && flags_.c.of == Of::host) which |= flag::c;
  if (which != 0 && flags_.v.of == Of::host) which |= flag::v;
  for (const uint8_t bit : {flag::c, flag::v}) {
    if ((which & bit) == 0) continue;
    const FlagSource source = bit == flag::c ? flags_.c : flags_.v;
    uint8_t group = bit;
    if ((which & flag::c) && (which & flag::v) && flags_.c.serial == flags_.v.serial)
      group = flag::c | flag::v;
    const bool with_nz = (which & flag::nz) && flags_.nz == source;
    if (with_nz) {
      compute(source, x86::eax);
    } else if (!host_has(source, HostFlags::sum)) {
      compare(source);
    }
    settle_carries(group);
    if (with_nz) {
      store_nz(x86::eax);
      flags_.nz = {Of::memory, {}, {}, flags_.nz.serial};
      which &= static_cast<uint8_t>(~flag::nz);
    }
    which &= static_cast<uint8_t>(~group);
  }
  if ((which & flag::nz) == 0) return;
  const FlagSource nz = flags_.nz;
  if (nz.of == Of::value && nz.x.is_register()) {
    store_nz(registers_.read(nz.x.base, x86::eax));
  } else {
    compute(nz, x86::eax);
    store_nz(x86::eax);
  }
  flags_.nz = {Of::memory, {}, {}, nz.serial};
}

void FlagTracker::settle_from_host(uint8_t which, const Gp& result, bool borrow) {
  in_host(borrow ? HostFlags::difference : HostFlags::sum);
  set_sources(which & (flag::c | flag::v), {Of::host, {}, {}, 0});
  settle_carries(which & (flag::c | flag::v));
  if ((which & flag::nz) == 0) return;
  store_nz(result);
  set_sources(flag::nz, {});
}

namespace {

// By the guest's condition: EQ NE CS CC MI PL VS VC HI LS GE LT GT LE.
constexpr x86::CondCode condition_behind_difference[14] = {
    x86::CondCode::kZ, x86::CondCode::kNZ, x86::CondCode::kAE, x86::CondCode::kB,
    x86::CondCode::kS, x86::CondCode::kNS, x86::CondCode::kO,  x86::CondCode::kNO,
    x86::CondCode::kA, x86::CondCode::kBE, x86::CondCode::kGE, x86::CondCode::kL,
    x86::CondCode::kG, x86::CondCode::kLE};

}  // namespace

/// The condition as one of the host's, if one operation made all its flags.
std::optional<x86::CondCode> FlagTracker::condition_from_host(unsigned guest_condition) {
  const uint8_t read = flags_of_condition(guest_condition);
  const bool only_nz = (read & (flag::c | flag::v)) == 0;
  const FlagSource& first = only_nz ? flags_.nz : (read & flag::c) != 0 ? flags_.c : flags_.v;
  if ((read & flag::nz) != 0 && flags_.nz.serial != first.serial) return std::nullopt;
  if (!host_has(first, only_nz ? HostFlags::nz : HostFlags::sum)) {
    if (!first.pending()) return std::nullopt;
    if (!only_nz && first.of != Of::difference && first.of != Of::sum) return std::nullopt;
    compare(first);
  }
  const unsigned sort = guest_condition >> 1;
  if (host_flags_ != HostFlags::difference) {
    if (sort == 4) return std::nullopt;
    if (sort == 1) return (guest_condition & 1) != 0 ? x86::CondCode::kAE : x86::CondCode::kB;
  }
  return condition_behind_difference[guest_condition];
}

x86::CondCode FlagTracker::condition_from_memory(unsigned guest_condition) {
  const State& state = machine_.state;
  const bool inverse = (guest_condition & 1) != 0;
  const auto unless = [&](x86::CondCode code) { return inverse ? x86::negateCond(code) : code; };
  host_serial_ = 0;
  switch (guest_condition >> 1) {
    case 0:
      a_.cmp(code_.state_word(&state.z), 0);
      return unless(x86::CondCode::kZ);
    case 1:
      a_.cmp(code_.state_byte(&state.c), 0);
      return unless(x86::CondCode::kNZ);
    case 2:
      a_.cmp(code_.state_word(&state.n), 0);
      return unless(x86::CondCode::kS);
    case 3:
      a_.cmp(code_.state_byte(&state.v), 0);
      return unless(x86::CondCode::kNZ);
    case 4:  // C and not Z
      a_.movzx(x86::eax, code_.state_byte(&state.c));
      a_.neg(x86::eax);
      a_.test(code_.state_word(&state.z), x86::eax);
      return unless(x86::CondCode::kNZ);
    default:
      break;
  }
  a_.movzx(x86::eax, code_.state_byte(&state.v));
  a_.shl(x86::eax, 31);
  a_.xor_(x86::eax, code_.state_word(&state.n));
  if (guest_condition >> 1 == 5) return unless(x86::CondCode::kNS);
  a_.sar(x86::eax, 31);
  a_.not_(x86::eax);
  a_.test(code_.state_word(&state.z), x86::eax);
  return unless(x86::CondCode::kNZ);
}

x86::CondCode FlagTracker::condition(unsigned guest_condition) {
  if (const auto code = condition_from_host(guest_condition)) return *code;
  settle(flags_of_condition(guest_condition));
  return condition_from_memory(guest_condition);
}

uint32_t FlagTracker::recipe_of(const FlagSources& flags) {
  if (!flags.any_pending() && !flags.all_inherited() && flags.nz.of == Of::memory &&
      flags.c.of == Of::memory && flags.v.of == Of::memory)
    return 0;
  for (std::size_t i = recipes_.size(); i-- > 0 && i + 8 > recipes_.size();)
    if (recipes_[i] == flags) return static_cast<uint32_t>(i);
  recipes_.push_back(flags);
  return static_cast<uint32_t>(recipes_.size() - 1);
}

/// What the next block inherits. Where this one still inherits, no flag is left uncomputed: the
/// block before it has seen to that (stays_recoverable), unless it set no flags at all.
FlagSources FlagTracker::outgoing() const {
  FlagSources flags = flags_;
  if (flags.all_inherited()) return flags;
  for (FlagSource* source : {&flags.nz, &flags.c, &flags.v})
    if (source->of == Of::inherited) *source = {};
  return flags;
}

bool FlagTracker::leave_recoverable(uint32_t target) {
  // The words that are put aside within a block are the next one's.
  uint32_t lost = ((1u << (words_aside - words_left)) - 1) << FlagOperand::first_aside;
  if (!stays_recoverable(target, lost)) return false;
  std::array<unsigned, words_left> words{};
  for (unsigned n = 0; n < words_left; ++n) words[n] = words_aside - words_left + n;
  return put_aside(flag::all, lost, words.data(), words.size());
}

/// True if the block at an address sets all pending flags before it reads one or ends. The
/// registers that it writes before that are added to `written`.
bool FlagTracker::stays_recoverable(uint32_t target, uint32_t& written) const {
  constexpr unsigned furthest = 48;
  if (machine_.debugging.has_breakpoints()) return false;
  const Memory::Page& memory = machine_.memory.map().page(target);
  uint8_t pending =
      static_cast<uint8_t>((flags_.nz.pending() ? flag::nz : 0) |
                           (flags_.c.pending() ? flag::c : 0) | (flags_.v.pending() ? flag::v : 0));
  for (unsigned n = 0; n < furthest; ++n) {
    const uint32_t offset = target & (Memory::page_size - 1);
    if (target >> Memory::page_bits != plan_.head().address >> Memory::page_bits) return false;
    if (offset + 4 > Memory::page_size) return false;
    uint16_t halfwords[2];
    std::memcpy(halfwords, memory.read + offset, 4);
    const DecodedOp op = decode(target, halfwords[0], halfwords[1], 0, machine_.profile);
    // Who changes these bytes changes what this block does.
    for (uint32_t at = offset; at < offset + op.size; at += 2)
      plan_.page().code_lines |= 1ull << (at / 64);
    const FlagUse effects = flag_use(op);
    if ((effects.reads & pending) != 0) return false;
    pending &= static_cast<uint8_t>(~effects.kills);
    if (pending == 0) return true;
    if (ends_block(op) || is(op, kind::any_branch) || op.operation == Operation::it) return false;
    written |= written_by(op);
    target = next_address(op);
  }
  return false;
}

}  // namespace capsoc::armv7m
