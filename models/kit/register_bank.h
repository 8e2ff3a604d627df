#pragma once

#include <cstdint>
#include <functional>
#include <systemc>
#include <vector>

#include "kit/register_description.h"
#include "kit/register_target.h"

namespace capsoc::kit {

class RegisterBank;

/// The mask of a register without reserved bits.
inline constexpr uint32_t all_bits = 0xffffffff;
/// Bytes of a device's address range on the AN385.
inline constexpr uint64_t device_size = 4096;

/// One 32-bit register, a public member of its peripheral. The register description gives its
/// properties; its callbacks give all behaviour beyond storing a value.
class Register {
 public:
  /// Registers itself with `bank`. Throws std::logic_error if the offset is outside the bank, no
  /// multiple of 4 or already used: an error of the model, found at elaboration.
  Register(RegisterBank& bank, const registers::RegisterDescription& description);
  Register(const Register&) = delete;
  Register& operator=(const Register&) = delete;

  const registers::RegisterDescription& description() const { return description_; }

  /// True if a read has side effects.
  bool is_changed_by_reads() const { return static_cast<bool>(read_); }

  /// True if reads return a computed value instead of the stored one.
  bool is_computed() const { return peek_ || read_; }

  /// Access of the hardware: no callback runs, and the register's access type does not apply.
  uint32_t get() const { return value_; }
  void set(uint32_t value) { value_ = value; }
  bool any(uint32_t mask) const { return (value_ & mask) != 0; }
  void raise(uint32_t mask) { value_ |= mask; }
  void clear(uint32_t mask) { value_ &= ~mask; }
  void reset() { value_ = description_.reset; }

  /// Sets the function that computes the value in place of the stored one. It has no side effects;
  /// reads and the debugger use it.
  Register& on_peek(std::function<uint32_t()> peek);

  /// As on_peek, but with side effects (a FIFO pops). Only reads use it; the debugger gets
  /// on_peek's or the stored value.
  Register& on_read(std::function<uint32_t()> read);

  /// Declares reads side-effect-free and stable until a write or an event of this device
  /// (kit::SteadyRead). Not for registers that count with time.
  Register& steady() {
    steady_ = true;
    return *this;
  }

  /// Sets the function that runs instead of storing. Its argument has the written bits in the byte
  /// lanes of the write. Other lanes have the stored bits, with write-1-to-clear bits 0. Bits that
  /// cannot be written are 0.
  Register& on_write(std::function<void(uint32_t)> write);

  /// The default write: stores the writable bits, and clears the write-1-to-clear bits that are 1.
  void store(uint32_t value);

 private:
  friend class RegisterBank;
  uint32_t peek() const;
  uint32_t read();
  void write(uint32_t value, uint32_t lanes);
  uint32_t known_bits() const;

  registers::RegisterDescription description_;
  uint32_t value_;
  bool steady_ = false;
  std::function<uint32_t()> peek_;
  std::function<uint32_t()> read_;
  std::function<void(uint32_t)> write_;
};

/// Behaviour of offsets without a register.
enum class Holes {
  bus_error,   ///< answered like PSLVERR
  reads_zero,  ///< reads 0, writes are dropped (CMSDK peripherals)
};

/// A device whose registers are its public members. Logs errors of the guest: holes, writes to
/// read-only and reads of write-only registers, ones in reserved bits. Only holes are bus errors.
class RegisterBank : public RegisterTarget {
 public:
  RegisterBank(const sc_core::sc_module_name& name, uint64_t size,
               AccessRule rule = AccessRule::any_width, Holes holes = Holes::bus_error);

  /// All registers to their reset values; no callback runs.
  void reset_registers();

  /// Resets all registers; a device with more state overrides it.
  void reset() override { reset_registers(); }
  /// Saves or loads the words of all registers by name. A device with more state adds it.
  void visit(Archive& archive) override;
  const std::vector<Register*>& registers() const { return in_order_; }

 protected:
  bool read_word(uint32_t offset, uint32_t& value, bool debug) override;
  bool write_word(uint32_t offset, uint32_t value, uint32_t lanes) override;
  bool is_steady(uint32_t offset) const override;
  bool is_direct(uint32_t offset) const override { return by_word_[offset / 4] != nullptr; }
  /// True if there is a register whose reads have no side effects.
  bool has_plain_read(uint32_t offset) const;

 private:
  friend class Register;
  void enter(Register& added);

  Holes holes_;
  std::vector<Register*> by_word_;  // index: offset / 4; null: hole
  std::vector<Register*> in_order_;
};

}  // namespace capsoc::kit
