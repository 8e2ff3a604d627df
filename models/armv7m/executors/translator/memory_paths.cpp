#include "armv7m/executors/translator/memory_paths.h"

#include <cstddef>

#include "armv7m/machine.h"

namespace capsoc::armv7m {

using namespace asmjit;

namespace {

constexpr uint8_t none = FlagOperand::none;

unsigned log2_of(unsigned size) {
  return size == 4 ? 2 : size == 2 ? 1 : 0;
}

}  // namespace

unsigned MemoryPaths::Access::words() const {
  if (singles != 0) return singles;
  if (list != 0) return static_cast<unsigned>(__builtin_popcount(list));
  return ra != none ? 2 : 1;
}

void MemoryPaths::address_to(const Gp& to, const Address& address, uint32_t less) {
  const uint32_t offset = address.imm - less;
  const auto displacement = static_cast<int32_t>(offset);
  if (address.base == none) {
    if (address.index == none) {
      a_.mov(to, offset);
      return;
    }
    registers_.read_to(to, address.index);
    if (address.shift != 0) a_.shl(to, address.shift);
    a_.add(to, displacement);
    return;
  }
  const Gp base = registers_.read(address.base, x86::eax);
  if (address.index == none) {
    if (offset != 0 || base != to) a_.lea(to, sum_of(base, displacement));
    return;
  }
  const Gp index = registers_.read(address.index, x86::ecx);
  a_.lea(to, sum_of(base, index, address.shift, displacement));
}

/// One register to or from memory.
void MemoryPaths::move(const Access& access, unsigned n, const Mem& at) {
  if (access.store) {
    const Gp from = registers_.read(n, x86::edx);
    if (access.size == 4)
      a_.mov(at, from);
    else if (access.size == 2)
      a_.mov(at, from.r16());
    else
      a_.mov(at, from.r8());
    return;
  }
  const Gp to = registers_.destination(n, x86::edx);
  if (access.size == 4)
    a_.mov(to, at);
  else if (access.is_signed)
    a_.movsx(to, at);
  else
    a_.movzx(to, at);
  registers_.written(n, to);
}

void MemoryPaths::transfer(const Access& access, const Mem& place) {
  if (access.singles != 0) return transfer_singles(access, place);
  if (access.list == 0) {
    move(access, access.rd, place);
    if (access.ra != none) move(access, access.ra, place.cloneAdjusted(4));
    return;
  }
  int64_t offset = 0;
  for (uint32_t list = access.list & 0x7FFFu; list != 0; list &= list - 1, offset += 4)
    move(access, static_cast<unsigned>(__builtin_ctz(list)), place.cloneAdjusted(offset));
}

/// Floating-point registers, which are in the state.
void MemoryPaths::transfer_singles(const Access& access, const Mem& place) {
  const uint32_t* const first = machine_.state.fpu.singles() + access.first_single;
  for (unsigned i = 0; i < access.singles; ++i) {
    const Mem single = code_.state_word(first + i), word = place.cloneAdjusted(4 * i);
    a_.mov(x86::edx, access.store ? single : word);
    a_.mov(access.store ? word : single, x86::edx);
  }
}

/// What an address is likely to be.
std::optional<uint32_t> MemoryPaths::guess(const Address& address) const {
  if (address.base == none) return address.imm;
  if (!values_[address.base]) return std::nullopt;
  uint32_t value = *values_[address.base] + address.imm;
  if (address.index == none) return value;
  if (!values_[address.index]) return value;
  return value + (*values_[address.index] << address.shift);
}

/// The window an access probably goes to; below zero if there is none. What is not known is taken
/// to be where the stack is.
int MemoryPaths::window_of(const Address& address, bool store) const {
  const uint32_t place = guess(address).value_or(machine_.state.r[13] - 4);
  Access access;
  access.store = store;
  for (int i = 0; i < static_cast<int>(HostContext::windows * (store ? 2 : 1)); ++i) {
    const MemoryWindow& window = this->window(access, i);
    if (window.host != nullptr && place - window.base < window.units[0]) return i;
  }
  return -1;
}

void MemoryPaths::emit_access(const Step& step, const Access& access, const Address& address) {
  const Label exit = edges_.exit_at(step);
  const int window = window_of(address, access.store);
  if (window < 0) return look_up(address, access, exit, where_unmapped(step, access, address));
  slow_.push_back({a_.newLabel(), a_.newLabel(), exit, access, address, window});
  const SlowAccess slow = slow_.back();
  Mem place;
  if (reaches_directly(address, access, window)) {
    place = straight_through_window(address, access, window, slow.entry);
  } else {
    const unsigned shift = through_window(address, access, window, slow.entry);
    place = x86::ptr(x86::rcx, x86::rax, shift, 0, access.size);
  }
  charge_waits(access, window);
  transfer(access, place);
  a_.bind(slow.back);
}

/// Where an access goes whose page has no bytes: to a device, or out.
Label MemoryPaths::where_unmapped(const Step& step, const Access& access, const Address& address) {
  const std::optional<uint32_t> place = guess(address);
  if (!place || !devices_.has_call(step, *place)) return edges_.exit_at(step);
  return devices_.call(step, {access.size, access.rd, access.is_signed, access.store});
}

/// True for an access of one register whose address can be made in 64 bits by the access itself. A
/// sum that wraps is beyond the window then; with an index that is not scaled, which may well be
/// negative, it is made in 32 bits first.
bool MemoryPaths::reaches_directly(const Address& address, const Access& access, int number) const {
  constexpr uint32_t furthest = 0x7FFF'0000;  // what a displacement holds, and an offset more
  const bool scaled = address.index != none && address.shift != 0;
  const MemoryWindow& window = this->window(access, number);
  return access.words() == 1 && access.list == 0 && address.base != none &&
         (address.index == none || scaled) && window.fixed && window.base < furthest;
}

/// The host address of such an access. The load depends only on the registers of its address, so
/// the host computes the comparison in parallel with it.
x86::Mem MemoryPaths::straight_through_window(const Address& address, const Access& access,
                                              int number, const Label& otherwise) {
  const MemoryWindow& window = this->window(access, number);
  const unsigned unit = access.aligned ? 0 : log2_of(access.size);
  const auto offset = static_cast<int32_t>(address.imm);
  const auto displacement = static_cast<int32_t>(address.imm - window.base);
  const bool scaled = address.index != none;
  const Gp base = registers_.read(address.base, x86::eax);
  const Gp index = scaled ? registers_.read(address.index, x86::ecx) : Gp(x86::ecx);
  a_.lea(x86::rdx,
         scaled ? sum_of(base, index, address.shift, displacement) : sum_of(base, displacement));
  if (unit != 0) a_.rorx(x86::rdx, x86::rdx, unit);
  a_.cmp(x86::rdx, code_.context(&window.units[unit]));
  a_.jae(otherwise);
  if (!scaled) {
    a_.mov(x86::rcx, code_.context(&window.bias));
    return x86::ptr(x86::rcx, base.r64(), 0, offset, access.size);
  }
  if (base != x86::eax) a_.mov(x86::eax, base);
  a_.add(x86::rax, code_.context(&window.bias));
  return x86::ptr(x86::rax, index.r64(), address.shift, offset, access.size);
}

/// Those for reading, or those for writing, the ones with a fixed base first.
const MemoryWindow& MemoryPaths::window(const Access& access, int number) const {
  const auto n = static_cast<unsigned>(number);
  if (!access.store) return context_.read[n];
  return n < HostContext::windows ? context_.write_from_base[n]
                                  : context_.write[n - HostContext::windows];
}

void MemoryPaths::charge_waits(const Access& access, int window) {
  const uint64_t waits = uint64_t{this->window(access, window).wait_states} * access.words();
  if (waits != 0) a_.sub(x86::r15, code_.constant(waits << 32));
}

/// The place of an access that its window has, at rcx + (rax << result), or else to a label.
unsigned MemoryPaths::through_window(const Address& address, const Access& access, int number,
                                     const Label& otherwise) {
  const MemoryWindow& window = this->window(access, number);
  const unsigned unit = access.aligned ? 0 : log2_of(access.size);
  const unsigned words = access.words();
  address_to(x86::eax, address, window.fixed ? window.base : 0);
  if (!window.fixed) a_.sub(x86::eax, code_.context(&window.base, 4));
  if (unit != 0) a_.rorx(x86::eax, x86::eax, unit);
  if (words == 1) {
    a_.cmp(x86::eax, code_.context(&window.units[unit], 4));
  } else {
    const auto last = static_cast<int32_t>(words - 1);
    a_.lea(x86::rcx, x86::ptr(x86::rax, unit == 0 ? 4 * last : last));
    a_.cmp(x86::rcx, code_.context(&window.units[unit]));
  }
  a_.jae(otherwise);
  a_.mov(x86::rcx, code_.context(&window.host));
  return unit;
}

/// An access through the page table, with its wait states. Leaves where the access is not aligned
/// or not within one page, and goes elsewhere with its address in eax where the page is not mapped.
void MemoryPaths::look_up(const Address& address, const Access& access, const Label& exit,
                          const Label& unmapped) {
  static_assert(sizeof(Memory::Page) == 32);
  address_to(x86::eax, address, 0);
  if (access.size > 1) {
    a_.test(x86::al, access.size - 1);
    a_.jnz(exit);
  }
  a_.mov(x86::ecx, x86::eax);
  a_.shr(x86::ecx, Memory::page_bits);
  a_.shl(x86::ecx, 5);
  a_.add(x86::rcx, code_.context(&context_.pages));
  const auto member = static_cast<int32_t>(access.store ? offsetof(Memory::Page, write)
                                                        : offsetof(Memory::Page, read));
  a_.mov(x86::rdx, x86::ptr(x86::rcx, member));
  a_.test(x86::rdx, x86::rdx);
  if (access.store)
    emit_beside_code(address, access, exit, unmapped);
  else
    a_.jz(unmapped);
  a_.and_(x86::eax, Memory::page_size - 1);
  const unsigned words = access.words();
  if (words > 1) {
    a_.cmp(x86::eax, Memory::page_size - 4 * words);
    a_.ja(exit);
  }
  a_.mov(x86::ecx, x86::dword_ptr(x86::rcx, offsetof(Memory::Page, wait_states)));
  if (words > 1) a_.imul(x86::ecx, x86::ecx, words);
  code_.charge(x86::ecx);
  a_.add(x86::rax, x86::rdx);
  transfer(access, x86::ptr(x86::rax, 0, access.size));
}

/// A store to a page without direct bytes for it (ZF). It is made here if its line has no code and
/// is not closed for another reason; else the translated code exits. rcx = the page, eax = the
/// address; adds rdx = its bytes. The page's record is read each time, since code may be decoded
/// later.
void MemoryPaths::emit_beside_code(const Address& address, const Access& access, const Label& exit,
                                   const Label& unmapped) {
  const Label direct = a_.newLabel();
  a_.jnz(direct);
  a_.mov(x86::rdx, x86::ptr(x86::rcx, offsetof(Memory::Page, code)));
  a_.test(x86::rdx, x86::rdx);
  a_.jz(unmapped);
  a_.mov(x86::rcx, x86::ptr(x86::rdx, plan_.in_code_page(&plan_.page().code_lines)));
  a_.or_(x86::rcx, x86::ptr(x86::rdx, plan_.in_code_page(&plan_.page().closed_lines)));
  a_.or_(x86::rcx, code_.context(&context_.closed));
  a_.shr(x86::eax, 6);
  a_.bt(x86::rcx, x86::rax);
  a_.jc(exit);
  const auto to_last = static_cast<uint32_t>(4 * (access.words() - 1));
  if (to_last != 0) {
    address_to(x86::eax, address, 0u - to_last);
    a_.shr(x86::eax, 6);
    a_.bt(x86::rcx, x86::rax);
    a_.jc(exit);
  }
  address_to(x86::eax, address, 0);
  a_.mov(x86::ecx, x86::eax);
  a_.shr(x86::ecx, Memory::page_bits);
  a_.shl(x86::ecx, 5);
  a_.add(x86::rcx, code_.context(&context_.pages));
  a_.mov(x86::rdx, x86::ptr(x86::rcx, offsetof(Memory::Page, read)));
  a_.bind(direct);
}

void MemoryPaths::emit_slow_ways() {
  if (!slow_.empty()) code_.list_line("outside the window");
  for (const SlowAccess& slow : slow_) emit_slow(slow);
}

void MemoryPaths::emit_slow(const SlowAccess& slow) {
  a_.bind(slow.entry);
  const bool may_be_unaligned = slow.access.words() == 1 && slow.access.list == 0 &&
                                slow.access.singles == 0 && slow.access.size > 1 &&
                                !slow.access.aligned && !slow.access.exclusive &&
                                window(slow.access, slow.window).wait_states == 0;
  if (may_be_unaligned) emit_unaligned(slow);
  look_up(slow.address, slow.access, slow.exit, slow.exit);
  a_.jmp(slow.back);
}

/// An unaligned access of one register inside its window, which has no wait states. Each part
/// beyond the first takes a cycle: a halfword at an odd address has two parts, a word two or three.
/// Continues after this code if the access is aligned; exits where it may fault.
void MemoryPaths::emit_unaligned(const SlowAccess& slow) {
  const MemoryWindow& window = this->window(slow.access, slow.window);
  const Label aligned = a_.newLabel();
  address_to(x86::eax, slow.address, 0);
  a_.test(x86::al, slow.access.size - 1);
  a_.jz(aligned);
  a_.test(code_.state_word(&machine_.state.scb.word_with_unalign_trp()), Scb::unalign_trp);
  a_.jnz(slow.exit);
  a_.mov(x86::ecx, x86::eax);
  a_.sub(x86::ecx, code_.context(&window.base, 4));
  a_.lea(x86::rdx, x86::ptr(x86::rcx, slow.access.size));
  a_.cmp(x86::rdx, code_.context(&window.units[0]));
  a_.ja(slow.exit);
  if (slow.access.size == 4) {
    a_.and_(x86::eax, 1);
    a_.inc(x86::eax);
    code_.charge(x86::eax);
  } else {
    a_.sub(x86::r15, code_.constant(uint64_t{1} << 32));
  }
  a_.add(x86::rcx, code_.context(&window.host));
  transfer(slow.access, x86::ptr(x86::rcx, 0, slow.access.size));
  a_.jmp(slow.back);
  a_.bind(aligned);
}

}  // namespace capsoc::armv7m
