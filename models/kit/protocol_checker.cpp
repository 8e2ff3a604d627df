#include "kit/protocol_checker.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace capsoc::kit {
namespace {

std::string subject_of(const tlm::tlm_generic_payload& payload) {
  const char* const command = payload.is_read()    ? "read"
                              : payload.is_write() ? "write"
                                                   : "ignored command";
  return fmt::format("{} of {} bytes at {:#010x}", command, payload.get_data_length(),
                     payload.get_address());
}

bool is_enabled(const std::vector<unsigned char>& enables, std::size_t i) {
  return enables.empty() || enables[i % enables.size()] == TLM_BYTE_ENABLED;
}

}  // namespace

ProtocolChecker::ProtocolChecker(ProtocolWatch& watch, std::string name, Downstream downstream)
    : watch_(watch), name_(std::move(name)), downstream_(downstream) {}

void ProtocolChecker::require(bool holds, ProtocolRule rule, const std::string& subject) {
  if (holds) return;
  const ProtocolRuleText& text = describe(rule);
  watch_.report({rule, name_,
                 fmt::format("{}: {} (IEEE 1666-2011, {}): {} Here: {}", name_, text.name,
                             text.clause, text.text, subject)});
}

void ProtocolChecker::require(bool holds, ProtocolRule rule, const Payload& payload) {
  if (!holds) require(false, rule, subject_of(payload));
}

/// A transaction arrives from the initiator's side.
ProtocolChecker::Passage& ProtocolChecker::begin(const Payload& payload, Kind kind,
                                                 const sc_core::sc_time& delay) {
  ++watch_.calls_;
  ProtocolWatch::Path& path = watch_.path(payload);
  // An interconnect has passed it on: it may have changed the address, and nothing else.
  if (!path.empty() && path.back().kind == kind) check_unchanged(path.back().given, payload, kind);
  path.push_back({this, kind, Attributes(payload, kind), {}, sc_core::sc_time_stamp() + delay});
  return path.back();
}

/// What an initiator owes a transport call.
void ProtocolChecker::check_request(const Payload& payload) {
  using Rule = ProtocolRule;
  const bool moves_data = payload.get_command() != tlm::TLM_IGNORE_COMMAND;
  const unsigned char* const enables = payload.get_byte_enable_ptr();
  const unsigned enable_length = payload.get_byte_enable_length();
  require(!moves_data || payload.get_data_ptr() != nullptr, Rule::data_pointer_null, payload);
  require(!moves_data || payload.get_data_length() != 0, Rule::data_length_zero, payload);
  require(enables == nullptr || enable_length != 0, Rule::byte_enable_length_zero, payload);
  require(enables == nullptr || std::all_of(enables, enables + enable_length,
                                            [](unsigned char enable) {
                                              return enable == TLM_BYTE_DISABLED ||
                                                     enable == TLM_BYTE_ENABLED;
                                            }),
          Rule::byte_enable_value, payload);
  require(payload.get_streaming_width() != 0, Rule::streaming_width_zero, payload);
  require(payload.get_gp_option() == tlm::TLM_MIN_PAYLOAD, Rule::option_set, payload);
}

/// Next to it, where no interconnect has passed it on: nothing of an earlier answer is left.
void ProtocolChecker::check_request_is_new(const Passage& passage, const Payload& payload) {
  if (watch_.before(payload, passage) != nullptr) return;
  require(!payload.is_dmi_allowed(), ProtocolRule::dmi_hint_set, payload);
  require(payload.get_response_status() == tlm::TLM_INCOMPLETE_RESPONSE, ProtocolRule::response_set,
          payload);
}

void ProtocolChecker::check_unchanged(const Attributes& given, const Payload& payload, Kind kind) {
  using Rule = ProtocolRule;
  require(payload.get_command() == given.command, Rule::command_changed, payload);
  if (kind == Kind::dmi) return;
  require(payload.get_data_ptr() == given.data, Rule::data_pointer_changed, payload);
  require(payload.get_data_length() == given.length, Rule::data_length_changed, payload);
  if (kind != Kind::debug) {
    require(payload.get_byte_enable_ptr() == given.enables, Rule::byte_enable_pointer_changed,
            payload);
    require(payload.get_byte_enable_length() == given.enable_length,
            Rule::byte_enable_length_changed, payload);
    require(payload.get_streaming_width() == given.width, Rule::streaming_width_changed, payload);
    require(payload.get_gp_option() == given.option, Rule::option_changed, payload);
  }
  check_arrays(given, payload);
}

void ProtocolChecker::check_arrays(const Attributes& given, const Payload& payload) {
  using Rule = ProtocolRule;
  if (given.data != nullptr) {
    bool write_intact = true, disabled_intact = true;
    for (std::size_t i = 0; i < given.data_bytes.size(); ++i) {
      if (given.data[i] == given.data_bytes[i]) continue;
      if (given.command != tlm::TLM_READ_COMMAND)
        write_intact = false;
      else if (!is_enabled(given.enable_bytes, i))
        disabled_intact = false;
    }
    require(write_intact, Rule::write_data_changed, payload);
    require(disabled_intact, Rule::disabled_bytes_changed, payload);
  }
  if (given.enables != nullptr)
    require(std::equal(given.enable_bytes.begin(), given.enable_bytes.end(), given.enables),
            Rule::byte_enables_changed, payload);
}

/// On return, since on the way to the target an interconnect may set either.
void ProtocolChecker::check_cleared(const Attributes& given, const Payload& payload) {
  if (given.managed) return;
  bool none_left = true, none_lost = true;
  for (unsigned i = 0; i < given.extensions.size(); ++i) {
    const tlm::tlm_extension_base* const before = given.extensions[i];
    const tlm::tlm_extension_base* const now = payload.get_extension(i);
    if (before == nullptr && now != nullptr) none_left = false;
    if (before != nullptr && now != before) none_lost = false;
  }
  require(none_lost, ProtocolRule::extension_lost, payload);
  require(none_left, ProtocolRule::extension_left, payload);
  require(!payload.has_mm(), ProtocolRule::memory_manager_left, payload);
}

void ProtocolChecker::check_address(Passage& passage, const Payload& payload) {
  if (passage.answer)
    require(payload.get_address() == passage.answer->address, ProtocolRule::address_changed,
            payload);
  else if (downstream_ == Downstream::target)
    require(payload.get_address() == passage.given.address, ProtocolRule::address_changed, payload);
}

/// A response arrives from the target's side, and continues to the initiator's.
void ProtocolChecker::check_response(Passage& passage, const Payload& payload) {
  require(payload.get_response_status() != tlm::TLM_INCOMPLETE_RESPONSE,
          ProtocolRule::response_missing, payload);
  check_address(passage, payload);
  check_answer(passage, payload);
  answer(passage, payload);
}

/// What an interconnect may have done to the answer that came from the next hop.
void ProtocolChecker::check_answer(const Passage& passage, const Payload& payload) {
  if (!passage.answer) return;
  const ProtocolWatch::Answer& had = *passage.answer;
  require(payload.get_response_status() == had.status, ProtocolRule::response_changed, payload);
  require(had.dmi_allowed || !payload.is_dmi_allowed(), ProtocolRule::dmi_hint_raised, payload);
  if (payload.is_read() && payload.get_data_ptr() != nullptr)
    require(std::equal(had.data_bytes.begin(), had.data_bytes.end(), payload.get_data_ptr()),
            ProtocolRule::read_data_changed, payload);
}

/// Keeps what the hop before has to get.
void ProtocolChecker::answer(const Passage& passage, const Payload& payload) {
  Passage* const before = watch_.before(payload, passage);
  if (before == nullptr || before->kind != passage.kind) return;
  before->answer = {
      payload.get_address(), payload.get_response_status(), payload.is_dmi_allowed(), {}};
  if (payload.is_read() && payload.get_data_ptr() != nullptr)
    before->answer->data_bytes.assign(payload.get_data_ptr(),
                                      payload.get_data_ptr() + payload.get_data_length());
}

void ProtocolChecker::check_time(Passage& passage, const Payload& payload,
                                 const sc_core::sc_time& delay) {
  const sc_core::sc_time time = sc_core::sc_time_stamp() + delay;
  require(time >= passage.time, ProtocolRule::time_decreased, payload);
  passage.time = time;
}

void ProtocolChecker::check_references(const Payload& payload) {
  require(!payload.has_mm() || payload.get_ref_count() > 0, ProtocolRule::reference_count, payload);
}

void ProtocolChecker::b_transport(Forward& target, Payload& payload, sc_core::sc_time& delay) {
  require(sc_core::sc_get_current_process_handle().proc_kind() != sc_core::SC_METHOD_PROC_,
          ProtocolRule::called_from_method, payload);
  check_references(payload);
  check_request(payload);
  if (const Passage* const other = watch_.find(payload, this)) {
    require(other->kind != Kind::blocking, ProtocolRule::called_again, payload);
    require(other->kind != Kind::nonblocking, ProtocolRule::mixed_transport, payload);
    return target.b_transport(payload, delay);
  }
  Passage& passage = begin(payload, Kind::blocking, delay);
  const Ending ending{watch_, payload, passage};
  check_request_is_new(passage, payload);
  target.b_transport(payload, delay);
  if (watch_.find(payload, this) != &passage) return;  // forgotten
  check_time(passage, payload, delay);
  check_unchanged(passage.given, payload, Kind::blocking);
  check_cleared(passage.given, payload);
  check_response(passage, payload);
}

bool ProtocolChecker::get_direct_mem_ptr(Forward& target, Payload& payload, tlm::tlm_dmi& dmi) {
  using Rule = ProtocolRule;
  require(invalidating_ == 0, Rule::dmi_in_invalidation, payload);
  const tlm::tlm_dmi initial;
  require(dmi.get_dmi_ptr() == nullptr && dmi.get_start_address() == initial.get_start_address() &&
              dmi.get_end_address() == initial.get_end_address() && dmi.is_none_allowed() &&
              dmi.get_read_latency() == initial.get_read_latency() &&
              dmi.get_write_latency() == initial.get_write_latency(),
          Rule::dmi_descriptor_used, payload);
  const uint64_t address = payload.get_address();
  const Instant begun;
  Passage& passage = begin(payload, Kind::dmi, sc_core::SC_ZERO_TIME);
  const Ending ending{watch_, payload, passage};
  const bool granted = target.get_direct_mem_ptr(payload, dmi);
  require(begun.is_now(), Rule::dmi_waits, payload);
  check_unchanged(passage.given, payload, Kind::dmi);
  check_address(passage, payload);
  answer(passage, payload);
  check_grant(payload, dmi, address, granted);
  return granted;
}

/// Start and end tell of what is granted or what is refused.
void ProtocolChecker::check_grant(const Payload& payload, const tlm::tlm_dmi& dmi, uint64_t address,
                                  bool granted) {
  using Rule = ProtocolRule;
  const bool ordered = dmi.get_start_address() <= dmi.get_end_address();
  require(ordered, Rule::dmi_range_order, payload);
  require(!ordered || (address >= dmi.get_start_address() && address <= dmi.get_end_address()),
          Rule::dmi_range_address, payload);
  if (!granted) return;
  require(dmi.get_dmi_ptr() != nullptr, Rule::dmi_pointer_null, payload);
  require(!dmi.is_none_allowed() && (!payload.is_read() || dmi.is_read_allowed()) &&
              (!payload.is_write() || dmi.is_write_allowed()),
          Rule::dmi_access, payload);
}

void ProtocolChecker::invalidate_direct_mem_ptr(Backward& initiator, sc_dt::uint64 first,
                                                sc_dt::uint64 last) {
  require(first <= last, ProtocolRule::invalidation_order,
          fmt::format("{:#x} to {:#x}", uint64_t{first}, uint64_t{last}));
  ++invalidating_;
  initiator.invalidate_direct_mem_ptr(first, last);
  --invalidating_;
}

unsigned ProtocolChecker::transport_dbg(Forward& target, Payload& payload) {
  using Rule = ProtocolRule;
  require(payload.get_data_length() == 0 || payload.get_data_ptr() != nullptr,
          Rule::debug_pointer_null, payload);
  const Instant begun;
  Passage& passage = begin(payload, Kind::debug, sc_core::SC_ZERO_TIME);
  const Ending ending{watch_, payload, passage};
  const unsigned done = target.transport_dbg(payload);
  require(begun.is_now(), Rule::debug_waits, payload);
  require(done <= payload.get_data_length(), Rule::debug_count, payload);
  check_unchanged(passage.given, payload, Kind::debug);
  check_address(passage, payload);
  answer(passage, payload);
  return done;
}

}  // namespace capsoc::kit
