#include "armv7m/system/system_space.h"

#include <utility>

namespace capsoc::armv7m {
namespace {

constexpr uint32_t icsr_nmipendset = 1u << 31, icsr_pendsvset = 1u << 28, icsr_pendsvclr = 1u << 27,
                   icsr_pendstset = 1u << 26, icsr_pendstclr = 1u << 25, icsr_isrpending = 1u << 22,
                   icsr_rettobase = 1u << 11;
constexpr unsigned icsr_vectpending = 12;
constexpr uint32_t demcr_mon_pend = 1u << 17, demcr_trcena = 1u << 24;
constexpr uint32_t intid = 0x1FF;

uint32_t word_of(uint32_t address) {
  return address & ~3u;
}

}  // namespace

const SystemRegister* SystemSpace::find(uint32_t address) const {
  return context_.profile.registers->find(address);
}

bool SystemSpace::is_itm(uint32_t address) const {
  return in_itm(address) && context_.profile.has_itm;
}

bool SystemSpace::open_to_user(uint32_t address, bool write) const {
  const State& state = context_.state;
  if (is_itm(address)) return state.itm.open_to_user(address);
  return write && address == ppb::STIR && state.scb.user_may_pend();
}

uint32_t SystemSpace::icsr() const {
  const Nvic& nvic = context_.state.nvic;
  uint32_t value = context_.state.ipsr;
  if (nvic.active_count() <= 1) value |= find(ppb::ICSR)->description.reset & icsr_rettobase;
  value |= pending_.highest_pending(257) << icsr_vectpending;
  if (nvic.pending() >> exception::first_interrupt != 0) value |= icsr_isrpending;
  if (nvic.is_pending(exception::systick)) value |= icsr_pendstset;
  if (nvic.is_pending(exception::pendsv)) value |= icsr_pendsvset;
  if (nvic.is_pending(exception::nmi)) value |= icsr_nmipendset;
  return value;
}

uint32_t SystemSpace::peek(uint32_t address) const {
  const State& state = context_.state;
  const SystemRegister* target = find(address);
  if (target == nullptr) return 0;
  switch (target->room) {
    case Room::itm:
      return state.itm.read(address, state.scb.tracing());
    case Room::dwt:
      return state.dwt.read(address, context_.cycles(), state.scb.tracing());
    case Room::systick:
      return state.systick.read(address, context_.cycles());
    case Room::nvic:
      return state.nvic.read(address);
    case Room::scb:
      return state.scb.read(address, state.nvic);
    case Room::mpu:
      return state.mpu.read(address);
    case Room::exceptions:
      return address == ppb::ICSR ? icsr() : 0;
    case Room::debug:
      if (address == ppb::DHCSR) return context_.halting.control_and_status();
      return state.scb.demcr() |
             (state.nvic.is_pending(exception::debug_monitor) ? demcr_mon_pend : 0);
    case Room::fpu:
      return state.fpu.read(address);
    case Room::identity:
      return context_.profile.identity.word(address);
    case Room::constant:
      break;
  }
  return target->description.reset;
}

BusResult SystemSpace::read(uint32_t address, unsigned size, uint32_t& value, bool privileged) {
  State& state = context_.state;
  ++context_.private_accesses;
  value = 0;
  state.stalled = true;
  if (!privileged && !open_to_user(address, false)) return BusResult::bus_error;
  const uint32_t lowest = address & 3, word = peek(word_of(address)) >> (8 * lowest);
  value = size == 4 ? word : word & ((1u << (8 * size)) - 1);
  // COUNTFLAG is in byte 2 of SYST_CSR, MATCHED in byte 3 of FUNCTIONn.
  if (word_of(address) == ppb::SYST_CSR)
    state.systick.csr_read(context_.cycles(), lowest + size > 2);
  if (Dwt::is_function(address) && lowest + size > 3) state.dwt.matched_read(address);
  return BusResult::device;
}

BusResult SystemSpace::write(uint32_t address, unsigned size, uint32_t value, bool privileged) {
  if (!privileged && !open_to_user(address, true)) return BusResult::bus_error;
  ++context_.private_accesses;
  context_.state.stalled = true;
  if (is_itm(address)) {
    write_itm(word_of(address), size, value);
    return BusResult::device;
  }
  const unsigned shift = 8 * (address & 3);
  const uint32_t lanes = (size == 4 ? ~0u : (1u << (8 * size)) - 1) << shift;
  if (const SystemRegister* target = find(address))
    write_word(*target, word_of(address), {value << shift, lanes});
  context_.requests.raise(Requests::changed);
  return BusResult::device;
}

void SystemSpace::write_word(const SystemRegister& target, uint32_t address,
                             const LaneWrite& write) {
  State& state = context_.state;
  switch (target.room) {
    case Room::dwt:
      state.dwt.write(address, write, context_.cycles(), state.scb.tracing());
      select_observation();
      break;
    case Room::systick:
      state.systick.write(target, write, context_.cycles());
      break;
    case Room::nvic:
      write_interrupts(target, address, write);
      break;
    case Room::scb: {
      const bool folded = state.scb.folds_it();
      if (state.scb.write(target, write, state.nvic)) state.reset_request = true;
      // Blocks hold the time of each instruction.
      if (state.scb.folds_it() != folded) memory_.invalidate_all_code();
      memory_.watch_vectors();  // VTOR
      break;
    }
    case Room::mpu:
      state.mpu.write(address, write.value);
      memory_.regions_changed();
      break;
    case Room::fpu:
      state.fpu.write(target, write);
      break;
    case Room::exceptions:
      if (address == ppb::ICSR)
        write_icsr(write.over(0));
      else if ((write.value & intid) < exception::interrupts)
        pending_.pend(exception::first_interrupt + (write.value & intid));
      break;
    case Room::debug:
      // A program cannot write C_DEBUGEN, and without it nothing else of DHCSR.
      if (address == ppb::DHCSR) break;
      write_demcr(write.over(peek(address)));
      break;
    default:
      break;
  }
}

void SystemSpace::write_interrupts(const SystemRegister& target, uint32_t address,
                                   const LaneWrite& write) {
  State& state = context_.state;
  const uint64_t before = state.nvic.pending();
  state.nvic.write(target, address, write);
  const uint64_t newly = address == ppb::NVIC_ISPR ? state.nvic.pending() & ~before : 0;
  if (newly != 0 && state.scb.sends_event_on_pend()) state.event_register = true;
  if (!context_.listeners.pended) return;
  for (uint64_t left = newly; left != 0; left &= left - 1)
    context_.listeners.pended(static_cast<unsigned>(__builtin_ctzll(left)));
}

void SystemSpace::write_icsr(uint32_t value) {
  Nvic& nvic = context_.state.nvic;
  if ((value & icsr_nmipendset) != 0) pending_.pend(exception::nmi);
  if ((value & icsr_pendsvset) != 0) pending_.pend(exception::pendsv);
  if ((value & icsr_pendsvclr) != 0) nvic.set_pending(exception::pendsv, false);
  if ((value & icsr_pendstset) != 0) pending_.pend(exception::systick);
  if ((value & icsr_pendstclr) != 0) nvic.set_pending(exception::systick, false);
}

/// MON_PEND is the pending state itself, whatever MON_EN says. The vector catches are a halting
/// debugger's.
void SystemSpace::write_demcr(uint32_t value) {
  State& state = context_.state;
  const uint64_t now = context_.cycles();
  const uint32_t count = state.dwt.cycle_count(now, state.scb.tracing());
  state.scb.set_demcr(value);
  state.dwt.set_cycle_count(now, count);
  if ((value & demcr_mon_pend) != 0)
    pending_.pend(exception::debug_monitor);
  else
    state.nvic.set_pending(exception::debug_monitor, false);
  select_observation();
}

void SystemSpace::enable_tracing() {
  if (!context_.state.scb.tracing()) write_demcr(peek(ppb::DEMCR) | demcr_trcena);
}

void SystemSpace::select_observation() {
  State& state = context_.state;
  state.dwt.select(context_.cycles(), state.scb.tracing(), state.scb.monitor_steps());
  memory_.views_changed();
}

/// `value` holds what was written, from bit 0.
void SystemSpace::write_itm(uint32_t address, unsigned size, uint32_t value) {
  State& state = context_.state;
  const unsigned port = Itm::port_of(address);
  if (port >= Itm::ports) return state.itm.write(address, size, value);
  if (state.itm.port_enabled(port, state.scb.tracing()) && context_.listeners.stimulus)
    context_.listeners.stimulus(port, value, size);
}

void SystemSpace::check_access(const DecodedOp& op, uint32_t address, unsigned size) {
  const SystemRegister* target = find(address);
  const bool takes_parts = is_itm(address) || (target != nullptr && target->byte_accesses);
  if (size != 4 && !takes_parts) context_.report(Unpredictable::register_size, op.address);
}

void SystemSpace::check_write(const DecodedOp& op, uint32_t address, unsigned size, uint32_t value,
                              bool done) {
  constexpr uint32_t for_debuggers = 3, key = 0x05FA;
  if (address == ppb::AIRCR && value >> 16 == key && (value & for_debuggers) != 0)
    context_.report(Unpredictable::aircr_for_debuggers, op.address);
  const SystemRegister* target = find(address);
  if (target != nullptr && target->room == Room::mpu) check_mpu(op, address, value);
  if (done && target != nullptr && has_priorities(address))
    check_priorities(op, *target, address, size, value);
}

void SystemSpace::check_mpu(const DecodedOp& op, uint32_t address, uint32_t value) {
  const Mpu& mpu = context_.state.mpu;
  const auto tell = [&](Unpredictable which) { context_.report(which, op.address); };
  const bool enables = address == ppb::MPU_CTRL && (value & 1) != 0;
  for (unsigned number = 0; enables && number < Mpu::regions; ++number)
    mpu.check_region(number, tell);
  if (address < ppb::MPU_RNR) return;
  const bool rbar = address >= ppb::MPU_RBAR && ((address - ppb::MPU_RBAR) & 4) == 0;
  const bool names = address == ppb::MPU_RNR ? value > 7 : rbar && (value & 0x18) == 0x18;
  if (names) tell(Unpredictable::mpu_number);
  // A new RBAR may meet the old RASR: the region is looked at when it is complete.
  if (address > ppb::MPU_RBAR && !rbar) mpu.check_region(mpu.selected(), tell);
}

void SystemSpace::dropped_priority(const DecodedOp& op, const DroppedPriority& dropped) {
  State& state = context_.state;
  bool& told = state.priority_told[dropped.all_ones ? 1 : 0];
  if (told || !context_.listeners.priority) return;
  told = true;
  const uint32_t pc = std::exchange(state.pc, op.address);
  context_.listeners.priority(dropped);
  state.pc = pc;
}

/// Priority bits that a program has written and that are not implemented.
void SystemSpace::check_priorities(const DecodedOp& op, const SystemRegister& target,
                                   uint32_t address, unsigned size, uint32_t value) {
  const uint32_t writable = target.description.writable_mask >> (8 * (address & 3));
  const uint32_t implemented = context_.state.nvic.priority_mask();
  bool any = false, all_ones = true;
  for (unsigned i = 0; i < size; ++i) {
    const uint32_t field = value >> (8 * i) & 0xFF;
    const bool reserved = is_reserved_priority(address + i) || (writable >> (8 * i) & 0xFF) == 0;
    if (reserved || (field & ~implemented) == 0) continue;
    any = true;
    all_ones = all_ones && (field | implemented) == 0xFF;
  }
  if (any) dropped_priority(op, {word_of(address), value << (8 * (address & 3)), all_ones});
}

void SystemSpace::check_basepri(const DecodedOp& op, uint32_t value) {
  const uint32_t implemented = context_.state.nvic.priority_mask();
  value &= 0xFF;
  const bool all_ones = (value | implemented) == 0xFF;
  if ((value & ~implemented) != 0) dropped_priority(op, {0, value, all_ones});
}

}  // namespace capsoc::armv7m
