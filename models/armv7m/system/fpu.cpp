#include "armv7m/system/fpu.h"

#include "armv7m/profile.h"
#include "base/archive.h"

namespace capsoc::armv7m {

void Fpu::reset() {
  *this = {};
  fpccr_ = armv7m_fp_registers.at(ppb::FPCCR).description.reset;
}

void Fpu::visit(Archive& archive) {
  archive("s", s_);
  uint32_t fpscr = fpscr_.bits();
  archive("fpscr", fpscr);
  fpscr_ = Fpscr(fpscr);
  archive("cpacr", cpacr_);
  archive("fpccr", fpccr_);
  archive("fpcar", fpcar_);
  archive("fpdscr", fpdscr_);
}

void Fpu::allocate(uint32_t address, uint32_t ready, bool in_thread, bool privileged) {
  fpccr_ = (fpccr_ & enables) | ready | (in_thread ? thread : 0) | (privileged ? 0 : user) | lspact;
  fpcar_ = address & ~7u;
}

uint32_t Fpu::read(uint32_t address) const {
  switch (address) {
    case ppb::CPACR:
      return cpacr_;
    case ppb::FPCCR:
      return fpccr_;
    case ppb::FPCAR:
      return fpcar_;
    case ppb::FPDSCR:
      return fpdscr_;
    default:
      return 0;
  }
}

void Fpu::write(const SystemRegister& target, const LaneWrite& write) {
  switch (target.address()) {
    case ppb::CPACR:
      cpacr_ = write.over(cpacr_, target);
      break;
    case ppb::FPCCR:
      fpccr_ = write.over(fpccr_, target);
      break;
    case ppb::FPCAR:
      fpcar_ = write.over(fpcar_, target);
      break;
    case ppb::FPDSCR:
      fpdscr_ = write.over(fpdscr_, target);
      break;
    default:
      break;
  }
}

}  // namespace capsoc::armv7m
