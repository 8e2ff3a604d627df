#pragma once

#include <tlm_utils/simple_target_socket.h>

#include <cstdint>
#include <string_view>
#include <systemc>
#include <tlm>

#include "kit/component.h"

namespace capsoc::kit {

/// Access widths that a device accepts.
enum class AccessRule {
  any_width,  ///< bytes, halfwords and words, aligned
  word_only,  ///< 32-bit words with all byte lanes; others are answered like PSLVERR
};

/// The bus interface of a device with 32-bit little-endian registers. It accepts any payload and
/// answers invalid ones with an error. The derived class implements the registers.
///
/// Answers:
/// - TLM_COMMAND_ERROR_RESPONSE: no read or write
/// - TLM_BURST_ERROR_RESPONSE: a length other than 1, 2 or 4, or streaming
/// - TLM_BYTE_ENABLE_ERROR_RESPONSE: byte enables that are empty, or neither 0x00 nor 0xff
/// - TLM_ADDRESS_ERROR_RESPONSE: beyond the device, unaligned, against the AccessRule, or refused
///   by the register (PSLVERR on an APB)
class RegisterTarget : public sc_core::sc_module, public Component {
 public:
  tlm_utils::simple_target_socket<RegisterTarget> socket{"socket"};

  /// `size` in bytes, a multiple of 4.
  RegisterTarget(const sc_core::sc_module_name& name, uint64_t size, AccessRule rule);

  uint64_t size() const { return size_; }

  const char* component_name() const override { return basename(); }

  // For an initiator that knows the way to a register (kit::DirectRoute). `time`: of the access,
  // ahead of the kernel or not; `offset`: a multiple of 4.
  /// Reads the register as a transaction does at whose end SteadyRead::ahead was set. False: this
  /// device has notified no event by it.
  bool read_ahead(uint32_t offset, uint32_t& value, const sc_core::sc_time& time);
  /// SteadyRead::steady of a read at this time.
  bool reads_steadily(uint32_t offset) const { return is_steady(offset); }
  /// Writes those bits of `value` that are set in `lanes` as a transaction does with
  /// EarlyWrite::early. False: not taken, and nothing is done.
  bool write_early(uint32_t offset, uint32_t value, uint32_t lanes, const sc_core::sc_time& time);

  /// The word at `offset` as a debugger reads it, without the bus; 0 if there is none.
  uint32_t peek(uint32_t offset);

 protected:
  /// Reads the register at `offset` (a multiple of 4). With `debug` nothing in the device may
  /// change and nothing is reported. False: there is nothing to read (bus error).
  virtual bool read_word(uint32_t offset, uint32_t& value, bool debug) = 0;

  /// Writes those bits of `value` that are set in `lanes` (whole bytes, at least one) to the
  /// register at `offset`. False: bus error.
  virtual bool write_word(uint32_t offset, uint32_t value, uint32_t lanes) = 0;

  /// True: kit::SteadyRead holds for the register at `offset`.
  virtual bool is_steady(uint32_t /*offset*/) const { return false; }

  /// True: kit::SteadyRead::ahead holds for the register at `offset`, whatever the state.
  virtual bool is_read_ahead(uint32_t offset) const { return is_steady(offset); }

  /// True: kit::EarlyWrite holds for a write as write_word() gets it, in the present state. Asked
  /// before the write.
  virtual bool takes_early(uint32_t /*offset*/, uint32_t /*value*/, uint32_t /*lanes*/) const {
    return false;
  }

  /// True: the register at `offset` answers all accesses, at once: read_word() and write_word()
  /// neither wait nor return false. Accesses ahead of the kernel may leave out the transaction
  /// then.
  virtual bool is_direct(uint32_t /*offset*/) const { return false; }

  /// The instant of the access in progress: simulated time plus the initiator's delay. Outside an
  /// access: simulated time.
  sc_core::sc_time access_time() const {
    return direct_ != nullptr ? *direct_ : sc_core::sc_time_stamp() + delay_;
  }

  /// Call when an event of this device was notified in an access.
  void note_event() { notified_ = true; }

  /// Reports an error of the guest under this module's name.
  void report(std::string_view text) const;

 private:
  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay);
  unsigned transport_dbg(tlm::tlm_generic_payload& payload);
  tlm::tlm_response_status check(const tlm::tlm_generic_payload& payload) const;
  tlm::tlm_response_status access(tlm::tlm_generic_payload& payload);
  void describe_route(tlm::tlm_generic_payload& payload, uint32_t offset);

  uint64_t size_;
  AccessRule rule_;
  sc_core::sc_time delay_;
  const sc_core::sc_time* direct_ = nullptr;  // the time of an access without a transaction
  bool notified_ = false;                     // an event, in a read
};

}  // namespace capsoc::kit
