#include "armv7m/executors/translator/register_map.h"

namespace capsoc::armv7m {

using namespace asmjit;

namespace {

constexpr uint8_t not_pinned = 0xFF;
// By guest register: the number of the host's. The first three need no prefix in 32-bit operations.
constexpr uint8_t host_number[16] = {3,          6,  7,          8,          9,          10,
                                     11,         12, not_pinned, not_pinned, not_pinned, not_pinned,
                                     not_pinned, 13, 14,         not_pinned};

}  // namespace

bool pinned(unsigned n) {
  return n < 16 && host_number[n] != not_pinned;
}

Gp host_register(unsigned n) {
  return x86::gpd(host_number[n]);
}

x86::Mem RegisterMap::in_state(unsigned n) const {
  if (n >= FlagOperand::first_aside)
    return code_.context(&context_.aside[n - FlagOperand::first_aside], 4);
  return x86::dword_ptr(x86::rbp, static_cast<int32_t>(4 * n));
}

Operand RegisterMap::at(unsigned n) const {
  return pinned(n) ? Operand(host_register(n)) : Operand(in_state(n));
}

x86::Gp RegisterMap::read(unsigned n, const Gp& scratch) {
  if (pinned(n)) return host_register(n);
  read_to(scratch, n);
  return scratch;
}

void RegisterMap::read_to(const Gp& to, unsigned n) {
  if (n == literal_pc) {
    a_.mov(to, pc_);
  } else if (!pinned(n)) {
    a_.mov(to, in_state(n));
  } else if (host_register(n) != to) {
    a_.mov(to, host_register(n));
  }
}

void RegisterMap::write(unsigned n, const Gp& from) {
  if (!pinned(n))
    a_.mov(in_state(n), from);
  else if (host_register(n) != from)
    a_.mov(host_register(n), from);
}

void RegisterMap::load(uint32_t registers) {
  for (unsigned n = 0; n < 16; ++n)
    if (pinned(n) && (registers >> n & 1) != 0) a_.mov(host_register(n), in_state(n));
}

void RegisterMap::store(uint32_t registers) {
  for (unsigned n = 0; n < 16; ++n)
    if (pinned(n) && (registers >> n & 1) != 0) a_.mov(in_state(n), host_register(n));
}

uint32_t RegisterMap::changed_by_calls() {
  // System V: all but rbx, rbp and r12 to r15.
  uint32_t set = 0;
  for (unsigned n = 0; n < 16; ++n)
    if (pinned(n) && host_number[n] >= 6 && host_number[n] <= 11) set |= 1u << n;
  return set;
}

}  // namespace capsoc::armv7m
