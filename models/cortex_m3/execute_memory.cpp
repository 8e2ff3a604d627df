#include "cortex_m3/execute.h"
#include "cortex_m3/unpredictable.h"

namespace capsoc::cortex_m3 {
namespace {

template <typename T, bool is_signed>
uint32_t extend(uint32_t value) {
  return is_signed ? sign_extend(value, sizeof(T) * 8) : value;
}

}  // namespace

/// LDR, LDRB, LDRH, LDRSB, LDRSH in every addressing mode (A7.7.43 and on).
template <typename T, bool is_signed, Addressing mode>
bool Execute::load_one(Core& c, const Step& op) {
  uint32_t address, written_back = 0;
  if constexpr (mode == Addressing::literal) {
    address = (pc_of(op) & ~3u) + op.imm;
  } else if constexpr (mode == Addressing::reg) {
    address = c.state_.r[op.rn] + (c.state_.r[op.rm] << op.shift_n);
  } else if constexpr (mode == Addressing::post_indexed) {
    address = c.state_.r[op.rn];
    written_back = address + op.imm;
  } else {
    address = written_back = c.state_.r[op.rn] + op.imm;
  }
  uint32_t value = 0;
  Access access = mode == Addressing::unprivileged
                      ? c.load_slow(op, address, sizeof(T), value, true)
                      : c.load<T>(op, address, value);
  if (access == Access::fault) return false;
  if constexpr (mode == Addressing::pre_indexed || mode == Addressing::post_indexed) {
    c.state_.r[op.rn] = written_back;
  }
  if constexpr (sizeof(T) == 4) {
    if (__builtin_expect(op.rd == 15, 0)) {
      c.state_.cycles += timing::pipeline_refill;
      return c.bx_write_pc(value);
    }
  }
  c.state_.r[op.rd] = extend<T, is_signed>(value);
  return access == Access::ok || c.leave(op);
}

template <typename T, Addressing mode>
bool Execute::store_one(Core& c, const Step& op) {
  uint32_t address, written_back = 0;
  if constexpr (mode == Addressing::reg) {
    address = c.state_.r[op.rn] + (c.state_.r[op.rm] << op.shift_n);
  } else if constexpr (mode == Addressing::post_indexed) {
    address = c.state_.r[op.rn];
    written_back = address + op.imm;
  } else {
    address = written_back = c.state_.r[op.rn] + op.imm;
  }
  uint32_t value = c.state_.r[op.rd];
  Access access = mode == Addressing::unprivileged
                      ? c.store_slow(op, address, sizeof(T), static_cast<T>(value), true)
                      : c.store<T>(op, address, value);
  if (access == Access::fault) return false;
  if constexpr (mode == Addressing::pre_indexed || mode == Addressing::post_indexed) {
    c.state_.r[op.rn] = written_back;
  }
  return access == Access::ok || c.leave(op);
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
      // A table of cases, which the formatter indents anew each time.
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

bool Execute::ldrd(Core& c, const Step& op) {
  DualAddress a = dual_address(op, c.state_.r[op.rn]);
  if (a.address & 3) return c.fault(op, Core::Cause::unaligned, a.address);
  uint32_t low = 0, high = 0;
  Access first = c.load<uint32_t>(op, a.address, low);
  if (first == Access::fault) return false;
  Access second = c.load<uint32_t>(op, a.address + 4, high);
  if (second == Access::fault) return false;
  c.state_.r[op.rd] = low;
  c.state_.r[op.ra] = high;
  if (op.writeback) c.state_.r[op.rn] = a.written_back;
  return (first == Access::ok && second == Access::ok) || c.leave(op);
}

bool Execute::strd(Core& c, const Step& op) {
  DualAddress a = dual_address(op, c.state_.r[op.rn]);
  if (a.address & 3) return c.fault(op, Core::Cause::unaligned, a.address);
  Access first = c.store<uint32_t>(op, a.address, c.state_.r[op.rd]);
  if (first == Access::fault) return false;
  Access second = c.store<uint32_t>(op, a.address + 4, c.state_.r[op.ra]);
  if (second == Access::fault) return false;
  if (op.writeback) c.state_.r[op.rn] = a.written_back;
  return (first == Access::ok && second == Access::ok) || c.leave(op);
}

// The base is written last, so that a fault on the way leaves it for the restart.
bool Execute::load_multiple(Core& c, const Step& op, uint32_t address, uint32_t written_back) {
  if (address & 3) return c.fault(op, Core::Cause::unaligned, address);
  std::array<uint32_t, 16> loaded;
  bool stay = true;
  for (uint32_t list = op.imm; list != 0; list &= list - 1, address += 4) {
    Access a = c.load<uint32_t>(op, address, loaded[static_cast<unsigned>(__builtin_ctz(list))]);
    if (a == Access::fault) return false;
    stay = stay && a == Access::ok;
  }
  for (uint32_t list = op.imm & 0x7FFF; list != 0; list &= list - 1) {
    unsigned n = static_cast<unsigned>(__builtin_ctz(list));
    c.state_.r[n] = loaded[n];
  }
  c.state_.r[13] &= ~3u;
  if (op.writeback && ((op.imm >> op.rn) & 1) == 0) c.state_.r[op.rn] = written_back;
  if (op.imm & 0x8000) {
    c.state_.cycles += timing::pipeline_refill;
    return c.bx_write_pc(loaded[15]);
  }
  return stay || c.leave(op);
}

bool Execute::store_multiple(Core& c, const Step& op, uint32_t address, uint32_t written_back) {
  if (address & 3) return c.fault(op, Core::Cause::unaligned, address);
  bool stay = true;
  for (uint32_t list = op.imm; list != 0; list &= list - 1, address += 4) {
    unsigned n = static_cast<unsigned>(__builtin_ctz(list));
    Access a = c.store<uint32_t>(op, address, read(c, op, n));
    if (a == Access::fault) return false;
    stay = stay && a == Access::ok;
  }
  if (op.writeback) c.state_.r[op.rn] = written_back;
  return stay || c.leave(op);
}

static uint32_t list_bytes(const Step& op) {
  return 4 * static_cast<uint32_t>(__builtin_popcount(op.imm & 0xFFFF));
}

bool Execute::ldm(Core& c, const Step& op) {
  uint32_t base = c.state_.r[op.rn];
  return load_multiple(c, op, base, base + list_bytes(op));
}
bool Execute::ldmdb(Core& c, const Step& op) {
  uint32_t low = c.state_.r[op.rn] - list_bytes(op);
  return load_multiple(c, op, low, low);
}
bool Execute::stm(Core& c, const Step& op) {
  uint32_t base = c.state_.r[op.rn];
  return store_multiple(c, op, base, base + list_bytes(op));
}
bool Execute::stmdb(Core& c, const Step& op) {
  uint32_t low = c.state_.r[op.rn] - list_bytes(op);
  return store_multiple(c, op, low, low);
}

// One processor and no other master with exclusives: the local monitor alone decides (A3.4).
template <typename T>
bool Execute::load_exclusive(Core& c, const Step& op) {
  uint32_t address = c.state_.r[op.rn] + op.imm, value = 0;
  if (address & (sizeof(T) - 1)) return c.fault(op, Core::Cause::unaligned, address);
  Access a = c.load<T>(op, address, value);
  if (a == Access::fault) return false;
  c.state_.exclusive = true;
  c.state_.exclusive_address = address;
  c.state_.r[op.rd] = value;
  return a == Access::ok || c.leave(op);
}

template <typename T>
bool Execute::store_exclusive(Core& c, const Step& op) {
  uint32_t address = c.state_.r[op.rn] + op.imm;
  if (address & (sizeof(T) - 1)) return c.fault(op, Core::Cause::unaligned, address);
  if (!c.state_.exclusive) {
    c.state_.r[op.ra] = 1;
    return true;
  }
  if (c.state_.exclusive_address != address)
    c.unpredictable(Unpredictable::exclusive_pair, op.address);
  Access a = c.store<T>(op, address, c.state_.r[op.rd]);
  if (a == Access::fault) return false;
  c.state_.exclusive = false;
  c.state_.r[op.ra] = 0;
  return a == Access::ok || c.leave(op);
}

bool Execute::ldrex(Core& c, const Step& op) {
  return load_exclusive<uint32_t>(c, op);
}
bool Execute::ldrexh(Core& c, const Step& op) {
  return load_exclusive<uint16_t>(c, op);
}
bool Execute::ldrexb(Core& c, const Step& op) {
  return load_exclusive<uint8_t>(c, op);
}
bool Execute::strex(Core& c, const Step& op) {
  return store_exclusive<uint32_t>(c, op);
}
bool Execute::strexh(Core& c, const Step& op) {
  return store_exclusive<uint16_t>(c, op);
}
bool Execute::strexb(Core& c, const Step& op) {
  return store_exclusive<uint8_t>(c, op);
}

bool Execute::clrex(Core& c, const Step&) {
  c.state_.exclusive = false;
  return true;
}

}  // namespace capsoc::cortex_m3
