// The private peripheral bus: NVIC, SCB, SysTick, MPU and DWT registers (ARM DDI 0403, B3 and C1).
#include <algorithm>
#include <utility>

#include "cortex_m3/core.h"

namespace capsoc::cortex_m3 {
namespace {

constexpr uint32_t ccr_usersetmpend = 2;

struct ShcsrBit {
  unsigned position;
  unsigned exception;
  bool pending;
};
constexpr ShcsrBit shcsr_bits[] = {{0, 4, false},  {1, 5, false},   {3, 6, false},   {7, 11, false},
                                   {8, 12, false}, {10, 14, false}, {11, 15, false}, {12, 6, true},
                                   {13, 4, true},  {14, 5, true},   {15, 11, true}};

/// NVIC_IPR0 to 7 and SHPR1 to 3.
bool has_priorities(uint32_t address) {
  return (address >= 0xE000E400 && address < 0xE000E420) ||
         (address >= 0xE000ED18 && address < 0xE000ED24);
}

constexpr unsigned reserved_exceptions[] = {7, 8, 9, 10, 13};

bool is_reserved_priority(uint32_t address) {
  for (unsigned number : reserved_exceptions)
    if (address == 0xE000ED14 + number) return true;
  return false;
}

}  // namespace

void Core::reset_system_control() {
  state_.nvic.pending = state_.nvic.active = state_.nvic.enabled = 0;
  state_.nvic.lines = 0;
  state_.nvic.priority.fill(0);
  state_.scb.vtor = state_.scb.prigroup = state_.scb.scr = state_.scb.shcsr = state_.scb.cfsr =
      state_.scb.hfsr = state_.scb.mmfar = state_.scb.bfar = state_.scb.dfsr = state_.scb.actlr =
          state_.scb.demcr = state_.dwt.ctrl = 0;
  state_.dwt = {};
  state_.scb.ccr = 0x200;  // STKALIGN, from r2p0 on
  state_.dwt.cyccnt_stopped = 0;
  state_.itm.ter = state_.itm.tpr = state_.itm.tcr = 0;
  state_.itm.unlocked = false;
  state_.mpu.ctrl = state_.mpu.rnr = 0;
  state_.mpu.rbar.fill(0);
  state_.mpu.rasr.fill(0);
  mpu_changed();
  select_view();
  state_.systick.csr = state_.systick.rvr = state_.systick.start = 0;
  state_.systick.countflag = false;
  state_.systick.start_cycle = state_.cycles;
  state_.systick.event = never;
}

uint32_t Core::icsr() const {
  uint32_t value = state_.ipsr;
  if (active_count() <= 1) value |= 1u << 11;  // RETTOBASE
  value |= highest_pending(257) << 12;
  if (state_.nvic.pending >> 16) value |= 1u << 22;
  if (state_.nvic.pending & 1u << 15) value |= 1u << 26;
  if (state_.nvic.pending & 1u << 14) value |= 1u << 28;
  if (state_.nvic.pending & 1u << 2) value |= 1u << 31;
  return value;
}

uint32_t Core::ppb_read_word(uint32_t address, bool) const {
  auto irqs = [](uint64_t mask) { return static_cast<uint32_t>(mask >> 16); };
  if (address >= 0xE000E400 && address < 0xE000E420) {
    uint32_t value = 0;
    std::memcpy(&value, &state_.nvic.priority[16 + (address - 0xE000E400)], 4);
    return value;
  }
  if (address >= 0xE000ED18 && address < 0xE000ED24) {
    uint32_t value = 0;
    std::memcpy(&value, &state_.nvic.priority[4 + (address - 0xE000ED18)], 4);
    return value;
  }
  if (in_itm(address)) return itm_read(address);
  if (in_dwt_comparators(address)) return dwt_read(address);
  bool wrapped = false;
  switch (address) {
    case 0xE0001000:
      return 0x40000000u | state_.dwt.ctrl;  // four comparators
    case 0xE0001004:
      return cycle_count();
    case 0xE000E004:
      return 0;  // ICTR: 32 lines
    case 0xE000E008:
      return state_.scb.actlr;
    case 0xE000E010: {
      systick_value(cycles(), wrapped);
      return state_.systick.csr | (state_.systick.countflag || wrapped ? 1u << 16 : 0);
    }
    case 0xE000E014:
      return state_.systick.rvr;
    case 0xE000E018:
      return systick_value(cycles(), wrapped);
    case 0xE000E01C:
      return 9999;  // TENMS: 10 ms of the 1 MHz reference, less one
    case 0xE000E100:
    case 0xE000E180:
      return irqs(state_.nvic.enabled);
    case 0xE000E200:
    case 0xE000E280:
      return irqs(state_.nvic.pending);
    case 0xE000E300:
      return irqs(state_.nvic.active);
    case 0xE000ED00:
      return 0x412FC231;  // CPUID: Cortex-M3 r2p1
    case 0xE000ED04:
      return icsr();
    case 0xE000ED08:
      return state_.scb.vtor;
    case 0xE000ED0C:
      return 0xFA050000u | state_.scb.prigroup << 8;
    case 0xE000ED10:
      return state_.scb.scr;
    case 0xE000ED14:
      return state_.scb.ccr;
    case 0xE000ED24: {
      uint32_t value = state_.scb.shcsr;
      for (const ShcsrBit& b : shcsr_bits) {
        value |= static_cast<uint32_t>(
                     ((b.pending ? state_.nvic.pending : state_.nvic.active) >> b.exception) & 1)
                 << b.position;
      }
      return value;
    }
    case 0xE000ED28:
      return state_.scb.cfsr;
    case 0xE000ED2C:
      return state_.scb.hfsr;
    case 0xE000ED30:
      return state_.scb.dfsr;
    case 0xE000ED34:
      return state_.scb.mmfar;
    case 0xE000ED38:
      return state_.scb.bfar;
    case 0xE000ED40:
      return 0x30;  // ID_PFR0
    case 0xE000ED44:
      return 0x200;  // ID_PFR1
    case 0xE000ED48:
      return 0x00100000;  // ID_DFR0
    case 0xE000ED50:
      return 0x30;  // ID_MMFR0
    case 0xE000ED60:
      return 0x01141110;  // ID_ISAR0
    case 0xE000ED64:
      return 0x02111000;
    case 0xE000ED68:
      return 0x21112231;
    case 0xE000ED6C:
      return 0x01111110;
    case 0xE000ED70:
      return 0x01310102;
    case 0xE000ED90:
      return 0x800;  // MPU_TYPE: eight regions
    case 0xE000ED94:
      return state_.mpu.ctrl;
    case 0xE000ED98:
      return state_.mpu.rnr;
    case 0xE000ED9C:
    case 0xE000EDA4:
    case 0xE000EDAC:
    case 0xE000EDB4:
      return state_.mpu.rbar[state_.mpu.rnr] | state_.mpu.rnr;
    case 0xE000EDA0:
    case 0xE000EDA8:
    case 0xE000EDB0:
    case 0xE000EDB8:
      return state_.mpu.rasr[state_.mpu.rnr];
    case 0xE000EDFC:
      return state_.scb.demcr | ((state_.nvic.pending >> 12) & 1) << 17;  // MON_PEND
    default:
      return 0;  // the rest reads as zero
  }
}

/// Without privilege only STIR answers, and only if CCR.USERSETMPEND lets it.
Core::Result Core::ppb_read(uint32_t address, unsigned size, uint32_t& value, bool priv) {
  value = 0;
  state_.stalled = true;
  if (!priv && !(in_itm(address) && itm_open_to_user(address))) return Result::bus_error;
  uint32_t word = ppb_read_word(address & ~3u, false) >> (8 * (address & 3));
  value = size == 4 ? word : word & ((1u << (8 * size)) - 1);
  if ((address & ~3u) == 0xE000E010) {
    // COUNTFLAG is in byte 2 of CSR, and reading it clears it.
    systick_sync();
    if ((address & 3) + size > 2) state_.systick.countflag = false;
    systick_schedule();
  }
  // MATCHED is in byte 3 of FUNCTIONn, and reading it clears it.
  if (in_dwt_comparators(address) && (address & 0xC) == 8 && (address & 3) + size > 3)
    state_.dwt.function[(address - 0xE0001020) / 16] &= ~(1u << 24);
  return Result::device;
}

Core::Result Core::ppb_write(uint32_t address, unsigned size, uint32_t value, bool priv) {
  bool stir = address == 0xE000EF00;
  const bool open = (stir && (state_.scb.ccr & ccr_usersetmpend)) ||
                    (in_itm(address) && itm_open_to_user(address));
  if (!priv && !open) return Result::bus_error;
  if (in_itm(address)) {
    state_.stalled = true;
    itm_write(address & ~3u, size, value);
    return Result::device;
  }
  state_.stalled = true;
  unsigned shift = 8 * (address & 3);
  uint32_t mask = (size == 4 ? ~0u : (1u << (8 * size)) - 1) << shift;
  ppb_write_word(address & ~3u, value << shift, mask);
  check_ = true;
  return Result::device;
}

void Core::write_nvic(uint32_t address, uint32_t value, uint32_t) {
  uint64_t mask = static_cast<uint64_t>(value) << 16;
  switch (address) {
    case 0xE000E100:
      state_.nvic.enabled |= mask;
      break;
    case 0xE000E180:
      state_.nvic.enabled &= ~mask;
      break;
    case 0xE000E200:
      if ((state_.scb.scr & 0x10) && (mask & ~state_.nvic.pending)) state_.event_register = true;
      state_.nvic.pending |= mask;
      break;
    case 0xE000E280:
      // A line that is high and not active pends again at once.
      state_.nvic.pending &= ~mask;
      state_.nvic.pending |=
          (static_cast<uint64_t>(state_.nvic.lines) << 16) & mask & ~state_.nvic.active;
      break;
    default:
      break;
  }
}

void Core::write_shcsr(uint32_t value) {
  state_.scb.shcsr = value & 0x70000;
  for (const ShcsrBit& b : shcsr_bits) {
    uint64_t& state = b.pending ? state_.nvic.pending : state_.nvic.active;
    uint64_t bit = uint64_t{1} << b.exception;
    state = ((value >> b.position) & 1) ? state | bit : state & ~bit;
  }
}

void Core::ppb_write_word(uint32_t address, uint32_t value, uint32_t mask) {
  auto merge = [&](uint32_t old) { return (old & ~mask) | (value & mask); };
  auto priorities = [&](unsigned first) {
    for (unsigned i = 0; i < 4; ++i) {
      if ((mask >> (8 * i)) & 0xFF) {
        state_.nvic.priority[first + i] = static_cast<uint8_t>((value >> (8 * i)) & priority_mask_);
      }
    }
  };
  if (address >= 0xE000E400 && address < 0xE000E420) return priorities(16 + (address - 0xE000E400));
  if (address >= 0xE000ED18 && address < 0xE000ED24) {
    priorities(4 + (address - 0xE000ED18));
    for (unsigned reserved : reserved_exceptions) state_.nvic.priority[reserved] = 0;
    return;
  }
  if (in_dwt_comparators(address)) return dwt_write(address, value, mask);
  if (address >= 0xE000E100 && address < 0xE000E300) return write_nvic(address, value & mask, mask);
  if (address >= 0xE000ED90 && address < 0xE000EDBC) return write_mpu(address, value);
  switch (address) {
    case 0xE0001000:
    case 0xE0001004:
      dwt_write(address, value, mask);
      break;
    case 0xE000EDFC:
      write_demcr(merge(ppb_peek(address)));
      break;
    case 0xE000E008:
      state_.scb.actlr = merge(state_.scb.actlr) & 7;
      break;
    case 0xE000E010:
      systick_sync();
      state_.systick.csr = merge(state_.systick.csr) & 7;
      systick_schedule();
      break;
    case 0xE000E014:
      systick_sync();
      state_.systick.rvr = merge(state_.systick.rvr) & 0xFFFFFF;
      systick_schedule();
      break;
    case 0xE000E018:
      systick_sync();
      state_.systick.start = 0;
      state_.systick.countflag = false;
      systick_schedule();
      break;
    case 0xE000ED04: {
      uint32_t v = value & mask;
      if (v & 1u << 31) pend(2);
      if (v & 1u << 28) pend(14);
      if (v & 1u << 27) state_.nvic.pending &= ~(uint64_t{1} << 14);
      if (v & 1u << 26) pend(15);
      if (v & 1u << 25) state_.nvic.pending &= ~(uint64_t{1} << 15);
      break;
    }
    case 0xE000ED08:
      state_.scb.vtor = merge(state_.scb.vtor) & 0x3FFFFF80;
      break;
    case 0xE000ED0C:
      if ((value & mask) >> 16 != 0x05FA) break;
      state_.scb.prigroup = (value >> 8) & 7;
      if (value & 4) state_.reset_request = true;
      break;
    case 0xE000ED10:
      state_.scb.scr = merge(state_.scb.scr) & 0x16;
      break;
    case 0xE000ED14:
      state_.scb.ccr = merge(state_.scb.ccr) & 0x31B;
      break;
    case 0xE000ED24:
      write_shcsr(merge(ppb_peek(address)));
      break;
    case 0xE000ED28:
      state_.scb.cfsr &= ~(value & mask);
      break;
    case 0xE000ED2C:
      state_.scb.hfsr &= ~(value & mask);
      break;
    case 0xE000ED30:
      state_.scb.dfsr &= ~(value & mask);
      break;
    case 0xE000ED34:
      state_.scb.mmfar = merge(state_.scb.mmfar);
      break;
    case 0xE000ED38:
      state_.scb.bfar = merge(state_.scb.bfar);
      break;
    case 0xE000EF00:
      if ((value & 0x1FF) < interrupt_count) pend(16 + (value & 0x1FF));
      break;
    default:
      break;
  }
}

/// Registers that answer to bytes and halfwords: priorities, CFSR, the stimulus ports (B3.1.1).
void Core::check_system_access(const Step& op, uint32_t address, unsigned size) {
  const bool takes_parts =
      has_priorities(address) || (address & ~3u) == 0xE000ED28 || in_itm(address);
  if (size != 4 && !takes_parts) unpredictable(Unpredictable::register_size, op.address);
}

void Core::check_mpu_region(const Step& op, unsigned number) {
  const uint32_t rasr = state_.mpu.rasr[number], bits = ((rasr >> 1) & 31) + 1;
  if ((rasr & 1) == 0) return;
  const bool misplaced = bits < 32 && (state_.mpu.rbar[number] & ((1u << bits) - 1)) != 0;
  if (bits < 5)
    unpredictable(Unpredictable::mpu_size, op.address);
  else if (misplaced)
    unpredictable(Unpredictable::mpu_base, op.address);
  if (bits < 8 && (rasr >> 8 & 0xFF) != 0) unpredictable(Unpredictable::mpu_subregions, op.address);
  if ((rasr >> 24 & 7) == 4) unpredictable(Unpredictable::mpu_permissions, op.address);
}

/// What a program has written to a register that takes anything.
void Core::check_system_write(const Step& op, uint32_t address, uint32_t value) {
  constexpr uint32_t for_debuggers = 3, key = 0x05FA;
  if (address == 0xE000ED0C && value >> 16 == key && (value & for_debuggers) != 0)
    unpredictable(Unpredictable::aircr_for_debuggers, op.address);
  if (address == 0xE000ED94 && (value & 1) != 0)
    for (unsigned number = 0; number < state_.mpu.rasr.size(); ++number)
      check_mpu_region(op, number);
  if (address < 0xE000ED98 || address >= 0xE000EDBC) return;
  const bool names =
      address == 0xE000ED98 ? value > 7 : (address & 4) != 0 && (value & 0x18) == 0x18;
  if (names) unpredictable(Unpredictable::mpu_number, op.address);
  // A new RBAR may meet the old RASR: the region is looked at when it is complete.
  const bool completes = address >= 0xE000EDA0 && (address & 4) == 0;
  if (completes) check_mpu_region(op, state_.mpu.rnr);
}

void Core::dropped_priority(const Step& op, const DroppedPriority& dropped) {
  bool& told = state_.priority_told[dropped.all_ones ? 1 : 0];
  if (told || !priority_listener_) return;
  told = true;
  const uint32_t pc = std::exchange(state_.pc, op.address);
  priority_listener_(dropped);
  state_.pc = pc;
}

/// Priority bits that a program has written and that are not implemented.
void Core::check_priorities(const Step& op, uint32_t address, unsigned size, uint32_t value) {
  if (!has_priorities(address)) return;
  bool any = false, all_ones = true;
  for (unsigned i = 0; i < size; ++i) {
    const uint32_t field = value >> (8 * i) & 0xFF;
    if (is_reserved_priority(address + i) || (field & ~priority_mask_) == 0) continue;
    any = true;
    all_ones = all_ones && (field | priority_mask_) == 0xFF;
  }
  if (any) dropped_priority(op, {address & ~3u, value << (8 * (address & 3)), all_ones});
}

void Core::check_basepri(const Step& op, uint32_t value) {
  value &= 0xFF;
  const bool all_ones = (value | priority_mask_) == 0xFF;
  if ((value & ~priority_mask_) != 0) dropped_priority(op, {0, value, all_ones});
}

}  // namespace capsoc::cortex_m3
