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
/// Bytes of a device that the AN385 gives its own page.
inline constexpr uint64_t device_size = 4096;

/// One 32-bit register, a public member of its peripheral: what it is comes from the register
/// description, what it does beyond keeping a value from its callbacks.
class Register {
 public:
  /// Enters itself into `bank`. Throws std::logic_error when the offset lies outside the bank, is
  /// no multiple of 4 or is taken: a mistake in the model, found at elaboration.
  Register(RegisterBank& bank, const registers::RegisterDescription& description);
  Register(const Register&) = delete;
  Register& operator=(const Register&) = delete;

  const registers::RegisterDescription& description() const { return description_; }

  /// True if a read does something.
  bool is_changed_by_reads() const { return static_cast<bool>(read_); }

  /// True if reads do not show the stored value.
  bool is_computed() const { return peek_ || read_; }

  /// The hardware's side: no callback runs and access does not matter.
  uint32_t get() const { return value_; }
  void set(uint32_t value) { value_ = value; }
  bool any(uint32_t mask) const { return (value_ & mask) != 0; }
  void raise(uint32_t mask) { value_ |= mask; }
  void clear(uint32_t mask) { value_ &= ~mask; }
  void reset() { value_ = description_.reset; }

  /// Computes the value instead of the stored one, without side effects: used by reads and by the
  /// debugger.
  Register& on_peek(std::function<uint32_t()> peek);

  /// As on_peek, but with side effects (a FIFO pops): used by reads only; the debugger gets
  /// on_peek's or the stored value.
  Register& on_read(std::function<uint32_t()> read);

  /// A read does nothing, and its answer changes only when something is written or an event of this
  /// device comes (kit::SteadyRead): no register that counts with time.
  Register& steady() {
    steady_ = true;
    return *this;
  }

  /// Runs instead of storing. The argument has what the guest wrote, the stored bits in byte lanes
  /// that it left out (write-1-to-clear bits there are 0), and 0 in bits that cannot be written.
  Register& on_write(std::function<void(uint32_t)> write);

  /// What a write does without on_write: stores the writable bits, clears the write-1-to-clear bits
  /// that are 1.
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

/// What lies between the registers.
enum class Holes {
  bus_error,   ///< answered like PSLVERR
  reads_zero,  ///< reads 0, writes are dropped (CMSDK peripherals)
};

/// A device whose registers are its public members. Reports to the log what the guest does wrong:
/// holes, writes to read-only and reads of write-only registers, ones in reserved bits. Of these
/// only holes are bus errors.
class RegisterBank : public RegisterTarget {
 public:
  RegisterBank(const sc_core::sc_module_name& name, uint64_t size,
               AccessRule rule = AccessRule::any_width, Holes holes = Holes::bus_error);

  /// All registers to their reset values; no callback runs.
  void reset_registers();

  /// All registers; a device with more to do says so.
  void reset() override { reset_registers(); }
  /// The words of all registers by their names. A device adds what else it knows.
  void visit(Archive& archive) override;
  const std::vector<Register*>& registers() const { return in_order_; }

 protected:
  bool read_word(uint32_t offset, uint32_t& value, bool debug) override;
  bool write_word(uint32_t offset, uint32_t value, uint32_t lanes) override;
  bool is_steady(uint32_t offset) const override;
  /// There is a register that is not changed by reads.
  bool has_plain_read(uint32_t offset) const;

 private:
  friend class Register;
  void enter(Register& added);

  Holes holes_;
  std::vector<Register*> by_word_;  // index: offset / 4; null: hole
  std::vector<Register*> in_order_;
};

}  // namespace capsoc::kit
