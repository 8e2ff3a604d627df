// State that the protocol monitors of one system share.
#pragma once

#include <cstdint>
#include <list>
#include <optional>
#include <string>
#include <systemc>
#include <tlm>
#include <unordered_map>
#include <vector>

#include "kit/probe.h"
#include "kit/protocol_rules.h"

namespace capsoc::kit {

class ProtocolChecker;

/// A component broke a rule of the base protocol.
struct ProtocolViolation {
  ProtocolRule rule;
  std::string monitor;  ///< name of the monitor that saw it
  std::string text;     ///< monitor, rule, clause, what holds and the transaction, in one line
};

/// The violations that a system's monitors find, and the transactions under way. With these, two
/// monitors check what an interconnect between them does to a payload.
class ProtocolWatch {
 public:
  /// Notified of each violation. Without a listener a violation is an sc_report of severity
  /// SC_WARNING and message type "/capsoc/protocol".
  Probe<const ProtocolViolation&> violated;

  uint64_t violations() const { return violations_; }
  /// Calls that monitors have passed on, each monitor counted.
  uint64_t calls() const { return calls_; }

  /// Drops the transactions under way. Call after the system's initiators have dropped theirs.
  void forget_transactions() { under_way_.clear(); }

 private:
  friend class ProtocolChecker;

  enum class Kind { blocking, nonblocking, dmi, debug };

  /// A payload's attributes and arrays.
  struct Attributes {
    explicit Attributes(const tlm::tlm_generic_payload& payload, Kind kind);

    tlm::tlm_command command;
    uint64_t address;
    const unsigned char* data;
    unsigned length;
    const unsigned char* enables;
    unsigned enable_length, width;
    tlm::tlm_gp_option option;
    bool managed;
    std::vector<unsigned char> data_bytes, enable_bytes;
    std::vector<const tlm::tlm_extension_base*> extensions;
  };

  /// What a component answered.
  struct Answer {
    uint64_t address;
    tlm::tlm_response_status status;
    bool dmi_allowed;
    std::vector<unsigned char> data_bytes;  // of a read
  };

  /// A transaction on one hop.
  struct Passage {
    const ProtocolChecker* hop;
    Kind kind;
    Attributes given;
    std::optional<Answer> answer;  // of the next hop
    sc_core::sc_time time;         // effective local time of the last call or return
    tlm::tlm_phase_enum phase = tlm::UNINITIALIZED_PHASE;
    bool responded = false;
  };
  using Path = std::list<Passage>;  // from the initiator on

  Path& path(const tlm::tlm_generic_payload& payload) { return under_way_[&payload]; }
  /// The passage of a transaction on a hop, nullptr if there is none.
  Passage* find(const tlm::tlm_generic_payload& payload, const ProtocolChecker* hop);
  /// The passage before one of the same path, nullptr if it is the first.
  Passage* before(const tlm::tlm_generic_payload& payload, const Passage& passage);
  void end(const tlm::tlm_generic_payload& payload, const Passage* passage);
  void report(const ProtocolViolation& violation);

  std::unordered_map<const tlm::tlm_generic_payload*, Path> under_way_;
  uint64_t violations_ = 0, calls_ = 0;
};

}  // namespace capsoc::kit
