// On-chip or board RAM.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <systemc>
#include <tlm>

#include "kit/component.h"

namespace capsoc::bus {

/// Random-access memory of any transfer length and alignment, with byte enables, streaming width,
/// direct memory pointers and debug access. Wait states and aliases belong to the address map.
/// Initially zero, so that a run never depends on contents of the host's memory.
class Memory : public sc_core::sc_module,
               public kit::Component,
               private tlm::tlm_fw_transport_if<> {
 public:
  /// Takes one or several initiator sockets: ports of one memory, which do not delay each other.
  tlm::tlm_target_socket<32, tlm::tlm_base_protocol_types, 0> socket;

  /// `size` in bytes.
  Memory(const sc_core::sc_module_name& name, uint64_t size);

  uint8_t* data() { return bytes_.get(); }
  const uint8_t* data() const { return bytes_.get(); }
  uint64_t size() const { return size_; }

  /// A system reset: RAM keeps its contents.
  void reset() override {}
  const char* component_name() const override { return basename(); }
  void visit(Archive& archive) override { archive.memory("bytes", data(), size_); }
  /// A power cycle: all bytes 0.
  void clear();

 private:
  struct Release {
    void operator()(uint8_t* bytes) const { std::free(bytes); }
  };

  tlm::tlm_response_status access(tlm::tlm_generic_payload& payload);
  void copy(tlm::tlm_generic_payload& payload);
  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) override;
  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override;
  unsigned transport_dbg(tlm::tlm_generic_payload& payload) override;
  bool get_direct_mem_ptr(tlm::tlm_generic_payload& payload, tlm::tlm_dmi& dmi) override;

  uint64_t size_;
  // calloc, not a vector: 28 MiB of pages that most firmware never touches stay unmapped.
  std::unique_ptr<uint8_t, Release> bytes_;
};

}  // namespace capsoc::bus
