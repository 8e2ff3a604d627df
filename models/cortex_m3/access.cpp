#include "cortex_m3/core.h"

namespace capsoc::cortex_m3 {
namespace {

constexpr uint32_t ccr_unalign_trp = 1u << 3, ccr_bfhfnmign = 1u << 8;

bool in_ppb(uint32_t address) {
  return (address >> 20) == 0xE00;
}

/// The bit-band aliases of SRAM and peripherals (B3.1): 32 MiB of words for 1 MiB of bits.
bool in_bit_band_alias(uint32_t address) {
  return (address & 0xFE000000u) == 0x22000000u || (address & 0xFE000000u) == 0x42000000u;
}

struct BitBand {
  uint32_t address;  // of the unit of the access's size that holds the bit
  unsigned bit;
};
BitBand bit_band(uint32_t alias, unsigned size) {
  uint32_t offset = alias & 0x01FFFFFFu;
  uint32_t byte = (alias & 0xF0000000u) + (offset >> 5);
  uint32_t aligned = byte & ~(size - 1);
  return {aligned, (byte - aligned) * 8 + ((offset >> 2) & 7)};
}

}  // namespace

/// Tells the observer of an access that took the result; returns the result.
Core::Result Core::observe(const DirectAccess& access, Result result) const {
  DirectAccess told = access;
  told.ok = result <= Result::device;
  observer_->accessed(*this, told);
  return result;
}

Core::Result Core::read_physical(uint32_t address, unsigned size, uint32_t& value) {
  if (const Memory::Region* r = memory_.find(address);
      r != nullptr && r->size - (address - r->base) >= size) {
    value = 0;
    std::memcpy(&value, r->host + (address - r->base), size);
    if (sees_accesses_) observe({address, value, size, false, true}, Result::ok);
    state_.cycles += r->wait_states;
    return Result::ok;
  }
  unsigned wait = 0;
  value = 0;
  state_.stalled = true;
  bool good = bus_.read(address, size, value, wait, AccessKind::load);
  state_.cycles += wait;
  if (size < 4) value &= (1u << (8 * size)) - 1;
  return good ? Result::device : Result::bus_error;
}

Core::Result Core::write_physical(uint32_t address, unsigned size, uint32_t value) {
  if (const Memory::Region* r = memory_.find(address);
      r != nullptr && r->writable && r->size - (address - r->base) >= size) {
    std::memcpy(r->host + (address - r->base), &value, size);
    if (sees_accesses_) observe({address, value, size, true, true}, Result::ok);
    state_.cycles += r->wait_states;
    if (!memory_.invalidate(address, size)) return Result::ok;
    invalidated_ = true;  // the block that runs may be among them: leave it
    check_ = true;
    return Result::device;
  }
  unsigned wait = 0;
  state_.stalled = true;
  bool good = bus_.write(address, size, value, wait);
  state_.cycles += wait;
  return good ? Result::device : Result::bus_error;
}

Core::Result Core::read_aligned(uint32_t address, unsigned size, uint32_t& value, bool priv) {
  if (in_ppb(address)) {
    const Result result = ppb_read(address, size, value, priv);
    return sees_accesses_ ? observe({address, value, size, false}, result) : result;
  }
  if (!mpu_allows(address, false, false, priv)) return Result::violation;
  if (!in_bit_band_alias(address)) return read_physical(address, size, value);
  BitBand target = bit_band(address, size);
  Result result = read_physical(target.address, size, value);
  value = (value >> target.bit) & 1;
  return result;
}

Core::Result Core::write_aligned(uint32_t address, unsigned size, uint32_t value, bool priv) {
  if (in_ppb(address)) {
    const Result result = ppb_write(address, size, value, priv);
    return sees_accesses_ ? observe({address, value, size, true}, result) : result;
  }
  if (!mpu_allows(address, true, false, priv)) return Result::violation;
  if (!in_bit_band_alias(address)) return write_physical(address, size, value);
  BitBand target = bit_band(address, size);
  uint32_t unit = 0;
  Result result = read_physical(target.address, size, unit);
  if (result > Result::device) return result;
  unit = (unit & ~(1u << target.bit)) | (value & 1) << target.bit;
  return write_physical(target.address, size, unit);
}

namespace {
/// Largest aligned piece of what is left of an unaligned access.
unsigned piece(uint32_t address, unsigned left) {
  if ((address & 1) || left == 1) return 1;
  return 2;
}
}  // namespace

/// The host's bytes of an aligned access to a page that regions of the MPU share, nullptr if it has
/// to go the whole way. Such pages are those of most tasks' stacks.
uint8_t* Core::shared_page(uint32_t address, bool write, bool user) {
  if (!fast_pages_[address >> Memory::page_bits].mixed || user) return nullptr;
  const Memory::Page& page = memory_.page(address);
  uint8_t* bytes = write ? page.write : page.read;
  if (bytes == nullptr || !mpu_allows(address, write, false, privileged())) return nullptr;
  state_.cycles += page.wait_states;
  return bytes + (address & (Memory::page_size - 1));
}

Core::Access Core::load_slow(const Step& op, uint32_t address, unsigned size, uint32_t& value,
                             bool user) {
  const bool priv = privileged() && !user;
  const bool unaligned = (address & (size - 1)) != 0;
  if (unaligned && ((state_.scb.ccr & ccr_unalign_trp) || in_ppb(address))) {
    fault(op, Cause::unaligned, address);
    return Access::fault;
  }
  state_.pc = op.address;  // what a device reports, it reports of this instruction
  value = 0;
  if (const uint8_t* bytes = unaligned ? nullptr : shared_page(address, false, user)) {
    std::memcpy(&value, bytes, size);
    return Access::ok;
  }
  if (in_ppb(address)) check_system_access(op, address, size);
  access_offset_ = op.cycles_before;
  Result worst = Result::ok;
  uint32_t failed = address;
  for (unsigned done = 0; done < size;) {
    unsigned part = unaligned ? piece(address + done, size - done) : size;
    uint32_t bits = 0;
    Result result = read_aligned(address + done, part, bits, priv);
    if (result > worst) worst = result;
    if (result > Result::device) {
      if (result == Result::violation) failed += done;
      break;
    }
    value |= bits << (8 * done);
    if (done != 0) ++state_.cycles;
    done += part;
  }
  access_offset_ = 0;
  if (worst == Result::ok && !user && !unaligned) fill_view(address);
  if (unaligned) check_unaligned(op, address, size);
  if (watches_data() && worst <= Result::device && watched(address, size, false))
    worst = Result::device;
  if (worst > Result::device) {
    value = 0;
    return failed_access(op, worst, failed);
  }
  return worst == Result::ok ? Access::ok : Access::leave;
}

Core::Access Core::store_slow(const Step& op, uint32_t address, unsigned size, uint32_t value,
                              bool user) {
  const bool priv = privileged() && !user;
  const bool unaligned = (address & (size - 1)) != 0;
  if (unaligned && ((state_.scb.ccr & ccr_unalign_trp) || in_ppb(address))) {
    fault(op, Cause::unaligned, address);
    return Access::fault;
  }
  state_.pc = op.address;
  if (uint8_t* bytes = unaligned ? nullptr : shared_page(address, true, user)) {
    std::memcpy(bytes, &value, size);
    return Access::ok;
  }
  if (in_ppb(address)) check_system_access(op, address, size);
  access_offset_ = op.cycles_before;
  Result worst = Result::ok;
  uint32_t failed = address;
  if (size < 4) value &= (1u << (8 * size)) - 1;
  for (unsigned done = 0; done < size;) {
    unsigned part = unaligned ? piece(address + done, size - done) : size;
    uint32_t bits = part == 4 ? value : (value >> (8 * done)) & ((1u << (8 * part)) - 1);
    Result result = write_aligned(address + done, part, bits, priv);
    if (result == Result::bus_error && buffered(op, address + done)) {
      imprecise_bus_fault();
      result = Result::device;
    }
    if (result > worst) worst = result;
    if (result > Result::device) {
      if (result == Result::violation) failed += done;
      break;
    }
    if (done != 0) ++state_.cycles;
    done += part;
  }
  access_offset_ = 0;
  if (worst == Result::ok && !user && !unaligned) fill_view(address);
  if (in_ppb(address)) {
    check_system_write(op, address, value);
    if (worst <= Result::device) check_priorities(op, address, size, value);
  }
  if (unaligned) check_unaligned(op, address, size);
  if (watches_data() && worst <= Result::device && watched(address, size, true))
    worst = Result::device;
  if (worst > Result::device) return failed_access(op, worst, failed);
  return worst == Result::ok ? Access::ok : Access::leave;
}

/// The fault of a data access. `address`, for MMFAR or BFAR: of an unaligned access the part that
/// the MPU forbids, but at a bus error what was asked for (Cortex-M3 Devices Generic User Guide).
/// CCR.BFHFNMIGN lets handlers at priority -1 and -2 probe the bus (B3.2.8): the status is
/// recorded, a load gives 0, and the handler goes on.
Core::Access Core::failed_access(const Step& op, Result result, uint32_t address) {
  const Cause cause = result == Result::bus_error ? Cause::data_bus : Cause::data_access;
  if (cause == Cause::data_bus && (state_.scb.ccr & ccr_bfhfnmign) != 0 &&
      execution_priority() < 0) {
    record_cause(cause, address);
    return Access::leave;
  }
  fault(op, cause, address);
  return Access::fault;
}

/// Whether the write buffer takes a store and its bus error comes later, as IMPRECISERR: the
/// accesses to Normal and Device memory are buffered, those to Strongly-ordered memory (the private
/// peripheral bus, and regions of the MPU with TEX, C and B zero), of bit-band aliases (a locked
/// read and write) and of store-exclusives (they wait for the answer) are not. ACTLR.DISDEFWBUF
/// ends the buffering where the default map decides. The model's bus answers at once, so the
/// exception is taken behind the instruction that stored, if its priority allows.
bool Core::buffered(const Step& op, uint32_t address) const {
  constexpr uint32_t disdefwbuf = 2, tex_c_b = 0x003B0000;
  const bool exclusive = op.operation >= Operation::strex && op.operation <= Operation::strexh;
  if (exclusive || in_ppb(address) || in_bit_band_alias(address)) return false;
  const int region = mpu_applies() ? mpu_region(address) : -1;
  if (region < 0) return (state_.scb.actlr & disdefwbuf) == 0;
  return (state_.mpu.rasr[static_cast<unsigned>(region)] & tex_c_b) != 0;
}

/// UNPREDICTABLE cases of an unaligned access that was made.
void Core::check_unaligned(const Step& op, uint32_t address, unsigned size) {
  if (op.operation == Operation::ldr && op.rd == 15)
    unpredictable(Unpredictable::load_to_pc_unaligned, op.address);
  if (state_.stalled || in_bit_band_alias(address))
    unpredictable(Unpredictable::device_unaligned, op.address);
  if (address + size < address) unpredictable(Unpredictable::address_wraps, op.address);
}

bool Core::debug_read(uint32_t address, void* data, uint32_t size) const {
  auto* bytes = static_cast<uint8_t*>(data);
  for (uint32_t i = 0; i < size; ++i) {
    uint32_t at = address + i;
    if (const Memory::Region* r = memory_.find(at)) {
      bytes[i] = r->host[at - r->base];
    } else if (in_ppb(at)) {
      bytes[i] = static_cast<uint8_t>(ppb_peek(at & ~3u) >> (8 * (at & 3)));
    } else {
      return false;
    }
  }
  return true;
}

bool Core::debug_write(uint32_t address, const void* data, uint32_t size) {
  const auto* bytes = static_cast<const uint8_t*>(data);
  if (in_ppb(address) && (size == 1 || size == 2 || size == 4) && (address & (size - 1)) == 0) {
    uint32_t value = 0;
    std::memcpy(&value, bytes, size);
    return ppb_write(address, size, value, true) <= Result::device;
  }
  for (uint32_t i = 0; i < size; ++i) {
    const Memory::Region* r = memory_.find(address + i);
    if (r == nullptr) return false;
    r->host[address + i - r->base] = bytes[i];
  }
  if (memory_.invalidate(address, size)) {
    invalidated_ = true;
    check_ = true;
  }
  return true;
}

}  // namespace capsoc::cortex_m3
