#include "armv7m/memory/memory_access.h"

#include <algorithm>

#include "armv7m/system/registers.h"

namespace capsoc::armv7m {
namespace {

struct BitBand {
  uint32_t address;  // of the unit of the access's size that holds the bit
  unsigned bit;
};
BitBand bit_band(uint32_t alias, unsigned size) {
  const uint32_t offset = alias & 0x01FFFFFFu;
  const uint32_t byte = (alias & 0xF0000000u) + (offset >> 5);
  const uint32_t aligned = byte & ~(size - 1);
  return {aligned, (byte - aligned) * 8 + ((offset >> 2) & 7)};
}

/// Peripheral, device and system space are execute-never in the default map (B3.1).
bool never_executes(uint32_t address) {
  const unsigned region = address >> 29;
  return region == 2 || region >= 5;
}

/// Normal memory in the default map (B3.1): the Code, SRAM and external RAM regions.
bool is_normal(uint32_t address) {
  const unsigned region = address >> 29;
  return region <= 1 || region == 3 || region == 4;
}

/// Largest aligned piece of what is left of an unaligned access.
unsigned piece(uint32_t address, unsigned left) {
  return (address & 1) != 0 || left == 1 ? 1 : 2;
}

uint32_t low_bytes(uint32_t value, unsigned size) {
  return size == 4 ? value : value & ((1u << (8 * size)) - 1);
}

/// Where an access lies in its page's bytes; nullptr without a page, or if it goes beyond.
template <typename Byte>
Byte* within(Byte* page, uint32_t address, unsigned size) {
  const uint32_t offset = address & (Memory::page_size - 1);
  return page != nullptr && offset + size <= Memory::page_size ? page + offset : nullptr;
}

/// After a write of the program: a bus response that ends no instruction.
bool succeeded(BusResult result) {
  return result <= BusResult::device;
}

}  // namespace

/// The bit-band aliases of SRAM and peripherals (B3.1): 32 MiB of words for 1 MiB of bits.
bool MemoryAccess::in_bit_band_alias(uint32_t address) const {
  const uint32_t alias = address & 0xFE000000u;
  return (alias == 0x22000000u || alias == 0x42000000u) && context_.profile.has_bit_bands;
}

void MemoryAccess::add_cycles(uint64_t cycles) {
  context_.state.cycles += cycles;
}

/// Tells the observer of an access that took the result; returns the result.
BusResult MemoryAccess::observe(const DirectAccess& access, BusResult result) const {
  DirectAccess told = access;
  told.ok = succeeded(result);
  context_.listeners.observer->accessed(context_.core(), told);
  return result;
}

/// Memory that the bus serves and does not grant. An access to it overlaps with its neighbours as
/// one to direct memory does; the one that maps direct memory does not.
bool MemoryAccess::is_memory_behind_bus(uint32_t address) const {
  return is_normal(address) && memory_.find(address) == nullptr;
}

BusResult MemoryAccess::read_physical(uint32_t address, unsigned size, uint32_t& value) {
  value = 0;
  const Memory::Page& page = memory_.page(address);
  if (const auto* bytes = within(page.read, address, size);
      bytes != nullptr && !context_.listeners.sees_accesses) {
    std::memcpy(&value, bytes, size);
    add_cycles(page.wait_states);
    return BusResult::ok;
  }
  if (const Memory::Region* r = memory_.find(address);
      r != nullptr && r->size - (address - r->base) >= size) {
    std::memcpy(&value, r->host + (address - r->base), size);
    if (context_.listeners.sees_accesses)
      observe({address, value, size, false, true}, BusResult::ok);
    add_cycles(r->wait_states);
    return BusResult::ok;
  }
  unsigned wait = 0;
  context_.state.stalled = true;
  const bool good = bus_.read(address, size, value, wait, AccessKind::load);
  if (good && is_memory_behind_bus(address)) context_.state.stalled = false;
  add_cycles(wait);
  value = low_bytes(value, size);
  return good ? BusResult::device : BusResult::bus_error;
}

BusResult MemoryAccess::write_physical(uint32_t address, unsigned size, uint32_t value) {
  const Memory::Page& page = memory_.page(address);
  if (auto* bytes = within(page.write, address, size);
      bytes != nullptr && !context_.listeners.sees_accesses) {
    std::memcpy(bytes, &value, size);
    add_cycles(page.wait_states);
    return BusResult::ok;
  }
  if (uint8_t* bytes = memory_.beside_code(address, size);
      bytes != nullptr && !context_.listeners.sees_accesses) {
    std::memcpy(bytes, &value, size);
    add_cycles(page.wait_states);
    return BusResult::ok;
  }
  if (const Memory::Region* r = memory_.find(address);
      r != nullptr && r->writable && r->size - (address - r->base) >= size) {
    std::memcpy(r->host + (address - r->base), &value, size);
    if (context_.listeners.sees_accesses)
      observe({address, value, size, true, true}, BusResult::ok);
    add_cycles(r->wait_states);
    if (context_.listeners.vectors && is_vector(address)) tell_of_vector({address, value, size});
    if (!memory_.invalidate(address, size)) return BusResult::ok;
    code_dropped_ = true;  // the block that runs may be among them: leave it
    context_.requests.raise(Requests::changed);
    return BusResult::device;
  }
  unsigned wait = 0;
  context_.state.stalled = true;
  const bool good = bus_.write(address, size, value, wait);
  if (good && is_memory_behind_bus(address)) context_.state.stalled = false;
  add_cycles(wait);
  return good ? BusResult::device : BusResult::bus_error;
}

bool MemoryAccess::is_vector(uint32_t address) const {
  return address - context_.state.scb.vector(0) < 4 * exception::count;
}

void MemoryAccess::tell_of_vector(const VectorWrite& write) {
  if (context_.listeners.vectors(write)) return;
  context_.listeners.vectors = nullptr;
  memory_.guard(0, 0);
}

BusResult MemoryAccess::shown(const DirectAccess& access, BusResult result) const {
  return context_.listeners.sees_accesses ? observe(access, result) : result;
}

BusResult MemoryAccess::read(uint32_t address, unsigned size, uint32_t& value, bool privileged) {
  if (in_private_peripherals(address)) {
    const BusResult result = private_bus_.read(address, size, value, privileged);
    return shown({address, value, size, false}, result);
  }
  if (!allows(address, false, false, privileged)) return BusResult::violation;
  if (!in_bit_band_alias(address)) return read_physical(address, size, value);
  const BitBand target = bit_band(address, size);
  const BusResult result = read_physical(target.address, size, value);
  value = (value >> target.bit) & 1;
  return result;
}

BusResult MemoryAccess::write(uint32_t address, unsigned size, uint32_t value, bool privileged) {
  return write(address, size, value, privileged, context_.state.at_negative_priority());
}

BusResult MemoryAccess::write(uint32_t address, unsigned size, uint32_t value, bool privileged,
                              bool at_negative_priority) {
  if (in_private_peripherals(address)) {
    const BusResult result = private_bus_.write(address, size, value, privileged);
    return shown({address, value, size, true}, result);
  }
  if (context_.state.mpu.applies(at_negative_priority) &&
      !regions_allow(address, true, false, privileged))
    return BusResult::violation;
  if (!in_bit_band_alias(address)) return write_physical(address, size, value);
  const BitBand target = bit_band(address, size);
  uint32_t unit = 0;
  const BusResult result = read_physical(target.address, size, unit);
  if (!succeeded(result)) return result;
  unit = (unit & ~(1u << target.bit)) | (value & 1) << target.bit;
  return write_physical(target.address, size, unit);
}

uint8_t* MemoryAccess::plain(uint32_t address, unsigned words, bool write) {
  if (mpu_applies() || context_.listeners.sees_accesses || in_private_peripherals(address) ||
      in_bit_band_alias(address))
    return nullptr;
  const Memory::Page& page = memory_.page(address);
  uint8_t* bytes = within(write ? page.write : page.read, address, 4 * words);
  if (bytes == nullptr && write) bytes = memory_.beside_code(address, 4 * words);
  if (bytes != nullptr) add_cycles(uint64_t{page.wait_states} * words);
  return bytes;
}

std::optional<Cause> MemoryAccess::fetch(uint32_t address, uint16_t& halfword) {
  if (never_executes(address) || !allows(address, false, true, context_.state.privileged()))
    return Cause::fetch_access;
  if (const auto* bytes = within(memory_.page(address).read, address, 2)) {
    std::memcpy(&halfword, bytes, 2);
    return std::nullopt;
  }
  if (const Memory::Region* r = memory_.find(address);
      r != nullptr && r->size - (address - r->base) >= 2) {
    std::memcpy(&halfword, r->host + (address - r->base), 2);
    return std::nullopt;
  }
  unsigned wait = 0;
  uint32_t value = 0;
  if (!bus_.read(address, 2, value, wait, AccessKind::fetch)) return Cause::fetch_bus;
  add_cycles(wait);
  halfword = static_cast<uint16_t>(value);
  return std::nullopt;
}

bool MemoryAccess::mpu_applies() const {
  return context_.state.mpu.applies(context_.state.at_negative_priority());
}

/// MPU rights do not differ within 32 bytes, so they are cached by line, with enough lines for a
/// task's stack and data. Where regions share pages, as the stacks of an RTOS do, every access is
/// checked here.
bool MemoryAccess::regions_allow(uint32_t address, bool write, bool fetch, bool privileged) {
  Line& line = lines_[address >> 5 & (lines_.size() - 1)];
  const uint32_t tag = address >> 5 | 1u << 31;
  if (line.tag != tag) line = {tag, context_.state.mpu.rights(address)};
  const unsigned kind = (write ? Right::write : 0) | (fetch ? Right::fetch : 0) |
                        (privileged ? Right::privileged : 0);
  return (line.rights >> kind & 1) != 0;
}

void MemoryAccess::regions_changed() {
  lines_.fill({});
  views_changed();
}

void MemoryAccess::views_changed() {
  memory_.clear_views();
  select_view();
  context_.requests.raise(Requests::changed);
}

void MemoryAccess::select_view() {
  watch_vectors();  // memory that was mapped again is direct again
  if (mpu_applies()) {
    pages_ =
        memory_.view(context_.state.privileged() ? Memory::View::privileged : Memory::View::user);
  } else if (watchpoints_.watches_data() || context_.listeners.sees_accesses) {
    pages_ = memory_.view(Memory::View::unprotected);
  } else {
    pages_ = memory_.table();
  }
}

/// After an access that the regions let through: the next ones to its page need no look at them.
void MemoryAccess::fill_view(uint32_t address) {
  const Memory::Page& page = memory_.page(address);
  if (pages_ == memory_.table() || page.read == nullptr || direct(address).mixed) return;
  const bool watches_loads = watchpoints_.watches_page(address, false);
  const bool watches_stores = watchpoints_.watches_page(address, true);
  if (context_.listeners.sees_accesses || (watches_loads && watches_stores)) return;
  Memory::Page& seen = memory_.view_page(pages_, address);
  seen.mixed = !context_.state.mpu.uniform_in_page(address, Memory::page_bits);
  if (seen.mixed) return;
  const bool privileged = context_.state.privileged();
  seen.wait_states = page.wait_states;
  if (!watches_loads && allows(address, false, false, privileged)) seen.read = page.read;
  if (!watches_stores && allows(address, true, false, privileged)) seen.write = page.write;
}

bool MemoryAccess::is_watched() const {
  return watchpoints_.watches_data() || context_.listeners.sees_accesses;
}

CodePage* MemoryAccess::executable_page(uint32_t address) {
  if (never_executes(address)) return nullptr;
  if (pages_ == memory_.table()) return memory_.code_page(address);
  const State& state = context_.state;
  if (!state.mpu.uniform_in_page(address, Memory::page_bits) ||
      !allows(address, false, true, state.privileged()))
    return nullptr;
  CodePage* code = memory_.code_page(address);
  if (code != nullptr) memory_.view_page(pages_, address).code = code;
  return code;
}

/// Host bytes of an aligned access to a page that MPU regions share, or of a store to a page with
/// code on other lines. nullptr: the access must take the slow path. Such pages hold most tasks'
/// stacks, and data after code or a vector table.
uint8_t* MemoryAccess::shared_page(uint32_t address, bool write, bool user) {
  if (write && pages_ == memory_.table()) {
    uint8_t* bytes = memory_.beside_code(address, 1);  // aligned: in one line
    if (bytes != nullptr) add_cycles(memory_.page(address).wait_states);
    return bytes;
  }
  if (!direct(address).mixed || user) return nullptr;
  const Memory::Page& page = memory_.page(address);
  uint8_t* bytes = write ? page.write : page.read;
  if (bytes == nullptr || !allows(address, write, false, context_.state.privileged()))
    return nullptr;
  add_cycles(page.wait_states);
  return bytes + (address & (Memory::page_size - 1));
}

bool MemoryAccess::must_be_aligned(uint32_t address) const {
  return context_.state.scb.traps_unaligned() || in_private_peripherals(address);
}

bool MemoryAccess::is_device(uint32_t address) {
  const unsigned region = address >> 29;
  return region == 2 || region == 5 || region == 6;
}

/// True if nothing but the MPU is between an instruction and a device, and that lets it through.
bool MemoryAccess::may_be_at_once(uint32_t address, bool write) {
  if (!is_device(address) || in_bit_band_alias(address)) return false;
  return is_whole_view() ||
         (!is_watched() && allows(address, write, false, context_.state.privileged()));
}

bool MemoryAccess::load_at_once(const AtOnce& access, uint32_t& value) {
  if (!may_be_at_once(access.address, false)) return false;
  context_.state.pc = access.instruction;
  context_.cycle_offset = access.cycles_before;
  unsigned wait = 0;
  const bool made = bus_.read_at_once(access.address, access.size, value, wait);
  context_.cycle_offset = 0;
  if (!made) return false;
  add_cycles(wait);
  value = low_bytes(value, access.size);
  return true;
}

bool MemoryAccess::store_at_once(const AtOnce& access, uint32_t value) {
  if (!may_be_at_once(access.address, true)) return false;
  context_.state.pc = access.instruction;
  context_.cycle_offset = access.cycles_before;
  unsigned wait = 0;
  const bool made =
      bus_.write_at_once(access.address, access.size, low_bytes(value, access.size), wait);
  context_.cycle_offset = 0;
  if (made) add_cycles(wait);
  return made;
}

Access MemoryAccess::load_slow(const Step& op, uint32_t address, unsigned size, uint32_t& value,
                               bool user) {
  const bool privileged = context_.state.privileged() && !user;
  const bool unaligned = (address & (size - 1)) != 0;
  if (unaligned && must_be_aligned(address)) {
    context_.fault(op, Cause::unaligned, address);
    return Access::fault;
  }
  if (!unaligned && !user && load_at_once({op.address, op.cycles_before, address, size}, value)) {
    context_.state.stalled = true;
    return Access::leave;
  }
  context_.state.pc = op.address;  // what a device reports, it reports of this instruction
  value = 0;
  if (const uint8_t* bytes = unaligned ? nullptr : shared_page(address, false, user)) {
    std::memcpy(&value, bytes, size);
    return Access::ok;
  }
  if (in_private_peripherals(address)) private_bus_.check_access(op, address, size);
  context_.cycle_offset = op.cycles_before;
  BusResult worst = BusResult::ok;
  uint32_t failed_at = address;
  for (unsigned done = 0; done < size;) {
    const unsigned part = unaligned ? piece(address + done, size - done) : size;
    uint32_t bits = 0;
    const BusResult result = read(address + done, part, bits, privileged);
    worst = std::max(worst, result);
    if (!succeeded(result)) {
      if (result == BusResult::violation) failed_at += done;
      break;
    }
    value |= bits << (8 * done);
    if (done != 0) add_cycles(1);
    done += part;
  }
  context_.cycle_offset = 0;
  const Access access = concluded(op, address, size, false, user, worst, failed_at);
  if (!succeeded(worst)) value = 0;
  return access;
}

Access MemoryAccess::store_slow(const Step& op, uint32_t address, unsigned size, uint32_t value,
                                bool user) {
  const bool privileged = context_.state.privileged() && !user;
  const bool unaligned = (address & (size - 1)) != 0;
  if (unaligned && must_be_aligned(address)) {
    context_.fault(op, Cause::unaligned, address);
    return Access::fault;
  }
  if (!unaligned && !user && store_at_once({op.address, op.cycles_before, address, size}, value)) {
    context_.state.stalled = true;
    return Access::leave;
  }
  context_.state.pc = op.address;
  if (uint8_t* bytes = unaligned ? nullptr : shared_page(address, true, user)) {
    std::memcpy(bytes, &value, size);
    return Access::ok;
  }
  if (in_private_peripherals(address)) private_bus_.check_access(op, address, size);
  context_.cycle_offset = op.cycles_before;
  BusResult worst = BusResult::ok;
  uint32_t failed_at = address;
  value = low_bytes(value, size);
  for (unsigned done = 0; done < size;) {
    const unsigned part = unaligned ? piece(address + done, size - done) : size;
    BusResult result =
        write(address + done, part, low_bytes(value >> (8 * done), part), privileged);
    if (result == BusResult::bus_error && buffered(op, address + done)) {
      pending_.imprecise_bus_fault({true, address, value, op.address, context_.cycles()});
      result = BusResult::device;
    }
    worst = std::max(worst, result);
    if (!succeeded(result)) {
      if (result == BusResult::violation) failed_at += done;
      break;
    }
    if (done != 0) add_cycles(1);
    done += part;
  }
  context_.cycle_offset = 0;
  if (in_private_peripherals(address))
    private_bus_.check_write(op, address, size, value, succeeded(worst));
  return concluded(op, address, size, true, user, worst, failed_at);
}

/// What follows from an access that went the slow way: direct pages, watchpoints, the fault.
Access MemoryAccess::concluded(const Step& op, uint32_t address, unsigned size, bool write,
                               bool user, BusResult worst, uint32_t failed_at) {
  const bool unaligned = (address & (size - 1)) != 0;
  if (worst == BusResult::ok && !user && !unaligned) fill_view(address);
  if (unaligned) check_unaligned(op, address, size);
  if (watchpoints_.watches_data() && succeeded(worst) && watchpoints_.watched(address, size, write))
    worst = BusResult::device;
  if (!succeeded(worst)) return failed(op, worst, failed_at);
  return worst == BusResult::ok ? Access::ok : Access::leave;
}

/// The fault of a data access. `address`, for MMFAR or BFAR: of an unaligned access the part that
/// the MPU forbids, but at a bus error what was asked for (Cortex-M3 Devices Generic User Guide).
/// CCR.BFHFNMIGN lets handlers at priority -1 and -2 probe the bus (B3.2.8): the status is
/// recorded, a load gives 0, and the handler continues.
Access MemoryAccess::failed(const Step& op, BusResult result, uint32_t address) {
  const Cause cause = result == BusResult::bus_error ? Cause::data_bus : Cause::data_access;
  Scb& scb = context_.state.scb;
  if (cause == Cause::data_bus && scb.ignores_bus_faults() && pending_.execution_priority() < 0) {
    scb.record(cause, address);
    return Access::leave;
  }
  context_.fault(op, cause, address);
  return Access::fault;
}

/// Whether the write buffer takes a store, so that its bus error comes later, as IMPRECISERR.
/// Accesses to Normal and Device memory are buffered. Not buffered are:
/// - accesses to Strongly-ordered memory: the private peripheral bus, and MPU regions with TEX, C
///   and B zero
/// - accesses to bit-band aliases (a locked read and write)
/// - store-exclusives, which wait for the answer
/// ACTLR.DISDEFWBUF ends the buffering where the default map decides. The model's bus answers at
/// once, so the exception is taken after the instruction that stored, if its priority allows.
bool MemoryAccess::buffered(const Step& op, uint32_t address) const {
  if (!context_.profile.has_write_buffer || is(op, kind::exclusive_store) ||
      in_private_peripherals(address) || in_bit_band_alias(address))
    return false;
  const State& state = context_.state;
  const auto by_region = mpu_applies() ? state.mpu.buffers(address) : std::nullopt;
  return by_region ? *by_region : !state.scb.write_buffer_is_off();
}

/// UNPREDICTABLE cases of an unaligned access that was made.
void MemoryAccess::check_unaligned(const Step& op, uint32_t address, unsigned size) {
  if (op.operation == Operation::ldr && op.rd == 15)
    context_.report(Unpredictable::load_to_pc_unaligned, op.address);
  if (context_.state.stalled || in_bit_band_alias(address))
    context_.report(Unpredictable::device_unaligned, op.address);
  if (address + size < address) context_.report(Unpredictable::address_wraps, op.address);
}

void MemoryAccess::invalidate_code(uint32_t address, uint32_t size) {
  if (!memory_.invalidate(address, size)) return;
  code_dropped_ = true;
  context_.requests.raise(Requests::changed);
}

void MemoryAccess::invalidate_all_code() {
  memory_.invalidate_all();
  code_dropped_ = true;
  context_.requests.raise(Requests::changed);
}

void MemoryAccess::collect() {
  if (!code_dropped_) return;
  code_dropped_ = false;
  memory_.collect();
  watch_vectors();
}

void MemoryAccess::watch_vectors() {
  if (context_.listeners.vectors) memory_.guard(context_.state.scb.vector(0), 4 * exception::count);
}

bool MemoryAccess::debug_read(uint32_t address, void* data, uint32_t size) const {
  auto* bytes = static_cast<uint8_t*>(data);
  for (uint32_t i = 0; i < size; ++i) {
    const uint32_t at = address + i;
    if (const Memory::Region* r = memory_.find(at)) {
      bytes[i] = r->host[at - r->base];
    } else if (in_private_peripherals(at)) {
      bytes[i] = static_cast<uint8_t>(private_bus_.peek(at & ~3u) >> (8 * (at & 3)));
    } else {
      return false;
    }
  }
  return true;
}

bool MemoryAccess::debug_write(uint32_t address, const void* data, uint32_t size) {
  const auto* bytes = static_cast<const uint8_t*>(data);
  const bool word_or_part = size == 1 || size == 2 || size == 4;
  if (in_private_peripherals(address) && word_or_part && (address & (size - 1)) == 0) {
    uint32_t value = 0;
    std::memcpy(&value, bytes, size);
    const bool good = succeeded(private_bus_.write(address, size, value, true));
    context_.state.stalled = false;  // the program's next instruction overlaps as it would have
    return good;
  }
  for (uint32_t i = 0; i < size; ++i) {
    const Memory::Region* r = memory_.find(address + i);
    if (r == nullptr) return false;
    r->host[address + i - r->base] = bytes[i];
  }
  invalidate_code(address, size);
  return true;
}

}  // namespace capsoc::armv7m
