#pragma once

#include <array>
#include <cstdint>

#include "armv7m/isa/single_precision.h"
#include "armv7m/system/registers.h"

namespace capsoc {
class Archive;
}

namespace capsoc::armv7m {

/// The registers of the floating-point extension (A2.5) and of its context (B3.2.20 to B3.2.22).
/// CONTROL.FPCA is with the other bits of CONTROL.
class Fpu {
 public:
  static constexpr unsigned registers = 32;
  /// What a frame has beyond the eight words: S0 to S15, FPSCR and a reserved word.
  static constexpr unsigned stacked = 16;

  /// What a handler may raise that finds the state unsaved: bits of FPCCR, of the exceptions that
  /// could preempt when its frame was allocated.
  struct Ready {
    static constexpr uint32_t hard_fault = 1u << 4, mem_manage = 1u << 5, bus_fault = 1u << 6,
                              monitor = 1u << 8;
  };

  void reset();
  void visit(Archive& archive);

  uint32_t s(unsigned n) const { return s_[n]; }
  void set_s(unsigned n, uint32_t value) { s_[n] = value; }
  /// Where they are, one after the other.
  const uint32_t* singles() const { return s_.data(); }
  Fpscr& status() { return fpscr_; }
  const Fpscr& status() const { return fpscr_; }

  /// CPACR lets programs use the extension (CP10; CP11 is to be the same).
  bool enabled(bool privileged) const {
    const uint32_t access = cpacr_ >> 20 & 3;
    return access == 3 || (access == 1 && privileged);
  }
  // FPCCR
  bool counts_contexts() const { return (fpccr_ & 1u << 31) != 0; }  ///< ASPEN
  bool saves_lazily() const { return (fpccr_ & 1u << 30) != 0; }     ///< LSPEN
  bool save_is_due() const { return (fpccr_ & lspact) != 0; }        ///< LSPACT
  void save_is_done() { fpccr_ &= ~lspact; }
  bool ready(uint32_t exception) const { return (fpccr_ & exception) != 0; }
  bool context_is_privileged() const { return (fpccr_ & user) == 0; }
  /// Of S0 in the frame that was allocated last.
  uint32_t save_address() const { return fpcar_; }
  /// UpdateFPCCR (B1.5.7): the state is saved to an address when something else wants the
  /// registers. `ready`: bits of Ready.
  void allocate(uint32_t address, uint32_t ready, bool thread, bool privileged);
  /// A new context begins (ExecuteFPCheck).
  void begin_context() { fpscr_.set_control(fpdscr_); }

  uint32_t read(uint32_t address) const;
  void write(const SystemRegister& target, const LaneWrite& write);

 private:
  static constexpr uint32_t lspact = 1u << 0, user = 1u << 1, thread = 1u << 3, enables = 3u << 30;

  std::array<uint32_t, registers> s_{};
  Fpscr fpscr_;
  uint32_t cpacr_ = 0, fpccr_ = 0, fpcar_ = 0, fpdscr_ = 0;
};

}  // namespace capsoc::armv7m
