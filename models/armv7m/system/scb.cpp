#include "armv7m/system/scb.h"

#include "armv7m/profile.h"
#include "base/archive.h"

namespace capsoc::armv7m {
namespace {

constexpr uint32_t cfsr_mmarvalid = 1u << 7, cfsr_bfarvalid = 1u << 15;

/// SHCSR shows what the NVIC knows.
struct ShcsrBit {
  unsigned position;
  unsigned exception;
  bool pending;
};
constexpr ShcsrBit shcsr_bits[] = {
    {0, exception::mem_manage, false},    {1, exception::bus_fault, false},
    {3, exception::usage_fault, false},   {7, exception::svcall, false},
    {8, exception::debug_monitor, false}, {10, exception::pendsv, false},
    {11, exception::systick, false},      {12, exception::usage_fault, true},
    {13, exception::mem_manage, true},    {14, exception::bus_fault, true},
    {15, exception::svcall, true}};

/// The bit of CFSR, and the exception.
struct Fault {
  unsigned bit;
  unsigned exception;
};
Fault fault_of(Cause cause) {
  switch (cause) {
    case Cause::undefined_instruction:
      return {16, exception::usage_fault};
    case Cause::invalid_state:
      return {17, exception::usage_fault};
    case Cause::invalid_pc:
      return {18, exception::usage_fault};
    case Cause::no_coprocessor:
      return {19, exception::usage_fault};
    case Cause::unaligned:
      return {24, exception::usage_fault};
    case Cause::divide_by_zero:
      return {25, exception::usage_fault};
    case Cause::fetch_bus:
      return {8, exception::bus_fault};
    case Cause::fetch_access:
      return {0, exception::mem_manage};
    case Cause::data_bus:
      return {9, exception::bus_fault};
    case Cause::data_access:
      return {1, exception::mem_manage};
    case Cause::stacking_bus:
      return {12, exception::bus_fault};
    case Cause::stacking_access:
      return {4, exception::mem_manage};
    case Cause::lazy_bus:
      return {13, exception::bus_fault};
    case Cause::lazy_access:
      return {5, exception::mem_manage};
    case Cause::unstacking_bus:
      return {11, exception::bus_fault};
    default:  // unstacking_access
      return {3, exception::mem_manage};
  }
}

}  // namespace

void Scb::reset(const SystemRegisters& registers) {
  *this = {};
  ccr_ = registers.at(ppb::CCR).description.reset;
}

void Scb::visit(Archive& archive) {
  archive("vtor", vtor_);
  archive.at_most("prigroup", prigroup_, 7u);
  archive("scr", scr_);
  archive("ccr", ccr_);
  archive("shcsr", shcsr_);
  archive("cfsr", cfsr_);
  archive("hfsr", hfsr_);
  archive("mmfar", mmfar_);
  archive("bfar", bfar_);
  archive("dfsr", dfsr_);
  archive("actlr", actlr_);
  archive("demcr", demcr_);
}

void Scb::set_demcr(uint32_t value) {
  constexpr uint32_t mon_pend = 1u << 17;  // the pending state itself, which the NVIC has
  demcr_ = value & armv7m_registers.at(ppb::DEMCR).description.writable_mask & ~mon_pend;
}

unsigned Scb::record(Cause cause, uint32_t address) {
  const Fault fault = fault_of(cause);
  cfsr_ |= 1u << fault.bit;
  if (cause == Cause::data_bus) {
    cfsr_ |= cfsr_bfarvalid;
    bfar_ = address;
  } else if (cause == Cause::data_access) {
    cfsr_ |= cfsr_mmarvalid;
    mmfar_ = address;
  }
  return fault.exception;
}

uint32_t Scb::fault_address(uint32_t otherwise) const {
  if ((cfsr_ & cfsr_bfarvalid) != 0) return bfar_;
  return (cfsr_ & cfsr_mmarvalid) != 0 ? mmfar_ : otherwise;
}

uint32_t Scb::read(uint32_t address, const Nvic& nvic) const {
  switch (address) {
    case ppb::ACTLR:
      return actlr_;
    case ppb::VTOR:
      return vtor_;
    case ppb::AIRCR:
      return armv7m_registers.at(ppb::AIRCR).description.reset | prigroup_ << 8;
    case ppb::SCR:
      return scr_;
    case ppb::CCR:
      return ccr_;
    case ppb::SHCSR: {
      uint32_t value = shcsr_;
      for (const ShcsrBit& b : shcsr_bits) {
        const bool set = b.pending ? nvic.is_pending(b.exception) : nvic.is_active(b.exception);
        value |= uint32_t{set} << b.position;
      }
      return value;
    }
    case ppb::CFSR:
      return cfsr_;
    case ppb::HFSR:
      return hfsr_;
    case ppb::DFSR:
      return dfsr_;
    case ppb::MMFAR:
      return mmfar_;
    case ppb::BFAR:
      return bfar_;
    default:
      return 0;
  }
}

bool Scb::write(const SystemRegister& target, const LaneWrite& write, Nvic& nvic) {
  constexpr uint32_t vectkey = 0x05FA, sysresetreq = 4;
  switch (target.address()) {
    case ppb::ACTLR:
      actlr_ = write.over(actlr_, target);
      break;
    case ppb::VTOR:
      vtor_ = write.over(vtor_, target);
      break;
    case ppb::AIRCR:
      if (write.over(0) >> 16 != vectkey) break;
      prigroup_ = (write.value & target.description.writable_mask) >> 8 & 7;
      return (write.value & sysresetreq) != 0;
    case ppb::SCR:
      scr_ = write.over(scr_, target);
      break;
    case ppb::CCR:
      ccr_ = write.over(ccr_, target);
      break;
    case ppb::SHCSR: {
      const uint32_t value = write.over(read(ppb::SHCSR, nvic));
      shcsr_ = value & target.description.writable_mask;
      for (const ShcsrBit& b : shcsr_bits) {
        const bool set = (value >> b.position & 1) != 0;
        b.pending ? nvic.set_pending(b.exception, set) : nvic.set_active(b.exception, set);
      }
      break;
    }
    case ppb::CFSR:
      cfsr_ = write.over(cfsr_, target);
      break;
    case ppb::HFSR:
      hfsr_ = write.over(hfsr_, target);
      break;
    case ppb::DFSR:
      dfsr_ = write.over(dfsr_, target);
      break;
    case ppb::MMFAR:
      mmfar_ = write.over(mmfar_, target);
      break;
    case ppb::BFAR:
      bfar_ = write.over(bfar_, target);
      break;
    default:
      break;
  }
  return false;
}

}  // namespace capsoc::armv7m
