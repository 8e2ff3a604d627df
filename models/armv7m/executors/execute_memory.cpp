#include "armv7m/executors/execute.h"
#include "armv7m/isa/unpredictable.h"

namespace capsoc::armv7m {
namespace {

template <typename T, bool is_signed>
uint32_t extend(uint32_t value) {
  return is_signed ? sign_extend(value, sizeof(T) * 8) : value;
}

}  // namespace

/// LDR, LDRB, LDRH, LDRSB, LDRSH in every addressing mode (A7.7.43 and on).
template <typename T, bool is_signed, Addressing mode>
bool Execute::load_one(Machine& cpu, const Step& op) {
  uint32_t address, written_back = 0;
  if constexpr (mode == Addressing::literal) {
    address = (pc_of(op) & ~3u) + op.imm;
  } else if constexpr (mode == Addressing::reg) {
    address = cpu.state.r[op.rn] + (cpu.state.r[op.rm] << op.shift.amount);
  } else if constexpr (mode == Addressing::post_indexed) {
    address = cpu.state.r[op.rn];
    written_back = address + op.imm;
  } else {
    address = written_back = cpu.state.r[op.rn] + op.imm;
  }
  uint32_t value = 0;
  Access access = mode == Addressing::unprivileged
                      ? cpu.memory.load_slow(op, address, sizeof(T), value, true)
                      : cpu.memory.load<T>(op, address, value);
  if (access == Access::fault) return false;
  if constexpr (mode == Addressing::pre_indexed || mode == Addressing::post_indexed) {
    cpu.state.r[op.rn] = written_back;
  }
  if constexpr (sizeof(T) == 4) {
    if (__builtin_expect(op.rd == 15, 0)) {
      cpu.refill(cpu.profile.timing.refill_loaded);
      return cpu.interwork_to(value);
    }
  }
  cpu.state.r[op.rd] = extend<T, is_signed>(value);
  return access == Access::ok || cpu.leave(op);
}

template <typename T, Addressing mode>
bool Execute::store_one(Machine& cpu, const Step& op) {
  uint32_t address, written_back = 0;
  if constexpr (mode == Addressing::reg) {
    address = cpu.state.r[op.rn] + (cpu.state.r[op.rm] << op.shift.amount);
  } else if constexpr (mode == Addressing::post_indexed) {
    address = cpu.state.r[op.rn];
    written_back = address + op.imm;
  } else {
    address = written_back = cpu.state.r[op.rn] + op.imm;
  }
  uint32_t value = cpu.state.r[op.rd];
  Access access = mode == Addressing::unprivileged
                      ? cpu.memory.store_slow(op, address, sizeof(T), static_cast<T>(value), true)
                      : cpu.memory.store<T>(op, address, value);
  if (access == Access::fault) return false;
  if constexpr (mode == Addressing::pre_indexed || mode == Addressing::post_indexed) {
    cpu.state.r[op.rn] = written_back;
  }
  return access == Access::ok || cpu.leave(op);
}

namespace {
template <typename T, bool is_signed>
struct Loads {
  static const Executors* pick(Addressing mode) {
    switch (mode) {
      case Addressing::pre_indexed:
        return &both<Execute::load_one<T, is_signed, Addressing::pre_indexed>>;
      case Addressing::post_indexed:
        return &both<Execute::load_one<T, is_signed, Addressing::post_indexed>>;
      case Addressing::reg:
        return &both<Execute::load_one<T, is_signed, Addressing::reg>>;
      case Addressing::literal:
        return &both<Execute::load_one<T, is_signed, Addressing::literal>>;
      case Addressing::unprivileged:
        return &both<Execute::load_one<T, is_signed, Addressing::unprivileged>>;
      default:
        return &both<Execute::load_one<T, is_signed, Addressing::offset>>;
    }
  }
};
template <typename T>
struct Stores {
  static const Executors* pick(Addressing mode) {
    switch (mode) {
      case Addressing::pre_indexed:
        return &both<Execute::store_one<T, Addressing::pre_indexed>>;
      case Addressing::post_indexed:
        return &both<Execute::store_one<T, Addressing::post_indexed>>;
      case Addressing::reg:
        return &both<Execute::store_one<T, Addressing::reg>>;
      case Addressing::unprivileged:
        return &both<Execute::store_one<T, Addressing::unprivileged>>;
      default:
        return &both<Execute::store_one<T, Addressing::offset>>;
    }
  }
};
}  // namespace

const Executors* Execute::memory_executors(const DecodedOp& op) {
  Addressing mode = op.addressing;
  switch (op.operation) {
    case Operation::ldr:
      return Loads<uint32_t, false>::pick(mode);
    case Operation::ldrb:
      return Loads<uint8_t, false>::pick(mode);
    case Operation::ldrh:
      return Loads<uint16_t, false>::pick(mode);
    case Operation::ldrsb:
      return Loads<uint8_t, true>::pick(mode);
    case Operation::ldrsh:
      return Loads<uint16_t, true>::pick(mode);
    case Operation::str:
      return Stores<uint32_t>::pick(mode);
    case Operation::strb:
      return Stores<uint8_t>::pick(mode);
    case Operation::strh:
      return Stores<uint16_t>::pick(mode);
#define ONE(name)       \
  case Operation::name: \
    return &both<name>;
      // A table of cases, which the formatter indents again each time.
      // clang-format off
    ONE(ldrd)
    ONE(strd)
    ONE(ldm)
    ONE(ldmdb)
    ONE(stm)
    ONE(stmdb)
    ONE(ldrex)
    ONE(ldrexb)
    ONE(ldrexh)
    ONE(strex)
    ONE(strexb)
    ONE(strexh)
    ONE(clrex)
      // clang-format on
#undef ONE
    default:
      return nullptr;
  }
}

namespace {
// LDRD, LDM, exclusives and their stores fault when unaligned whatever CCR says (A3.2.1).
struct DualAddress {
  uint32_t address, written_back;
};
}  // namespace

static DualAddress dual_address(const Step& op, uint32_t base) {
  if (op.addressing == Addressing::literal) base = pc_of(op) & ~3u;
  uint32_t moved = base + op.imm;
  return {op.addressing == Addressing::post_indexed ? base : moved, moved};
}

bool Execute::ldrd(Machine& cpu, const Step& op) {
  DualAddress a = dual_address(op, cpu.state.r[op.rn]);
  if (a.address & 3) return cpu.fault(op, Cause::unaligned, a.address);
  uint32_t low = 0, high = 0;
  Access first = cpu.memory.load<uint32_t>(op, a.address, low);
  if (first == Access::fault) return false;
  Access second = cpu.memory.load<uint32_t>(op, a.address + 4, high);
  if (second == Access::fault) return false;
  cpu.state.r[op.rd] = low;
  cpu.state.r[op.ra] = high;
  if (op.writeback) cpu.state.r[op.rn] = a.written_back;
  return (first == Access::ok && second == Access::ok) || cpu.leave(op);
}

bool Execute::strd(Machine& cpu, const Step& op) {
  DualAddress a = dual_address(op, cpu.state.r[op.rn]);
  if (a.address & 3) return cpu.fault(op, Cause::unaligned, a.address);
  Access first = cpu.memory.store<uint32_t>(op, a.address, cpu.state.r[op.rd]);
  if (first == Access::fault) return false;
  Access second = cpu.memory.store<uint32_t>(op, a.address + 4, cpu.state.r[op.ra]);
  if (second == Access::fault) return false;
  if (op.writeback) cpu.state.r[op.rn] = a.written_back;
  return (first == Access::ok && second == Access::ok) || cpu.leave(op);
}

// The base is written last, so that a fault on the way leaves it for the restart.
bool Execute::load_multiple(Machine& cpu, const Step& op, uint32_t address, uint32_t written_back) {
  if (address & 3) return cpu.fault(op, Cause::unaligned, address);
  std::array<uint32_t, 16> loaded;
  bool stay = true;
  for (uint32_t list = op.list.bits; list != 0; list &= list - 1, address += 4) {
    Access a =
        cpu.memory.load<uint32_t>(op, address, loaded[static_cast<unsigned>(__builtin_ctz(list))]);
    if (a == Access::fault) return false;
    stay = stay && a == Access::ok;
  }
  for (uint32_t list = op.list.bits & 0x7FFFu; list != 0; list &= list - 1) {
    unsigned n = static_cast<unsigned>(__builtin_ctz(list));
    cpu.state.r[n] = loaded[n];
  }
  cpu.state.r[13] &= ~3u;
  if (op.writeback && !op.list.has(op.rn)) cpu.state.r[op.rn] = written_back;
  if (op.list.has(15)) {
    cpu.refill(cpu.profile.timing.refill_loaded);
    return cpu.interwork_to(loaded[15]);
  }
  return stay || cpu.leave(op);
}

bool Execute::store_multiple(Machine& cpu, const Step& op, uint32_t address,
                             uint32_t written_back) {
  if (address & 3) return cpu.fault(op, Cause::unaligned, address);
  bool stay = true;
  for (uint32_t list = op.list.bits; list != 0; list &= list - 1, address += 4) {
    unsigned n = static_cast<unsigned>(__builtin_ctz(list));
    Access a = cpu.memory.store<uint32_t>(op, address, read(cpu, op, n));
    if (a == Access::fault) return false;
    stay = stay && a == Access::ok;
  }
  if (op.writeback) cpu.state.r[op.rn] = written_back;
  return stay || cpu.leave(op);
}

static uint32_t list_bytes(const Step& op) {
  return 4 * op.list.count();
}

bool Execute::ldm(Machine& cpu, const Step& op) {
  uint32_t base = cpu.state.r[op.rn];
  return load_multiple(cpu, op, base, base + list_bytes(op));
}
bool Execute::ldmdb(Machine& cpu, const Step& op) {
  uint32_t low = cpu.state.r[op.rn] - list_bytes(op);
  return load_multiple(cpu, op, low, low);
}
bool Execute::stm(Machine& cpu, const Step& op) {
  uint32_t base = cpu.state.r[op.rn];
  return store_multiple(cpu, op, base, base + list_bytes(op));
}
bool Execute::stmdb(Machine& cpu, const Step& op) {
  uint32_t low = cpu.state.r[op.rn] - list_bytes(op);
  return store_multiple(cpu, op, low, low);
}

// One processor and no other master with exclusives: the local monitor alone decides (A3.4).
template <typename T>
bool Execute::load_exclusive(Machine& cpu, const Step& op) {
  uint32_t address = cpu.state.r[op.rn] + op.imm, value = 0;
  if (address & (sizeof(T) - 1)) return cpu.fault(op, Cause::unaligned, address);
  Access a = cpu.memory.load<T>(op, address, value);
  if (a == Access::fault) return false;
  cpu.state.exclusive = true;
  cpu.state.exclusive_address = address;
  cpu.state.r[op.rd] = value;
  return a == Access::ok || cpu.leave(op);
}

template <typename T>
bool Execute::store_exclusive(Machine& cpu, const Step& op) {
  uint32_t address = cpu.state.r[op.rn] + op.imm;
  if (address & (sizeof(T) - 1)) return cpu.fault(op, Cause::unaligned, address);
  if (!cpu.state.exclusive) {
    cpu.state.r[op.ra] = 1;
    return true;
  }
  if (cpu.state.exclusive_address != address) cpu.report(Unpredictable::exclusive_pair, op.address);
  Access a = cpu.memory.store<T>(op, address, cpu.state.r[op.rd]);
  if (a == Access::fault) return false;
  cpu.state.exclusive = false;
  cpu.state.r[op.ra] = 0;
  return a == Access::ok || cpu.leave(op);
}

#define EXCLUSIVE(name, access)                      \
  bool Execute::name(Machine& cpu, const Step& op) { \
    return (access);                                 \
  }
EXCLUSIVE(ldrex, load_exclusive<uint32_t>(cpu, op))
EXCLUSIVE(ldrexh, load_exclusive<uint16_t>(cpu, op))
EXCLUSIVE(ldrexb, load_exclusive<uint8_t>(cpu, op))
EXCLUSIVE(strex, store_exclusive<uint32_t>(cpu, op))
EXCLUSIVE(strexh, store_exclusive<uint16_t>(cpu, op))
EXCLUSIVE(strexb, store_exclusive<uint8_t>(cpu, op))
#undef EXCLUSIVE

bool Execute::clrex(Machine& cpu, const Step&) {
  cpu.state.exclusive = false;
  return true;
}

}  // namespace capsoc::armv7m
