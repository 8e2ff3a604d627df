#include "kit/protocol_watch.h"

namespace capsoc::kit {

ProtocolWatch::Attributes::Attributes(const tlm::tlm_generic_payload& payload, Kind kind)
    : command(payload.get_command()),
      address(payload.get_address()),
      data(payload.get_data_ptr()),
      length(payload.get_data_length()),
      enables(payload.get_byte_enable_ptr()),
      enable_length(payload.get_byte_enable_length()),
      width(payload.get_streaming_width()),
      option(payload.get_gp_option()),
      managed(payload.has_mm()) {
  // A request for direct memory has a command and an address only, a debug transaction no enables.
  if (kind == Kind::dmi) return;
  if (data != nullptr) data_bytes.assign(data, data + length);
  if (kind == Kind::debug) return;
  if (enables != nullptr) enable_bytes.assign(enables, enables + enable_length);
  for (unsigned i = 0; i < tlm::max_num_extensions(); ++i)
    extensions.push_back(payload.get_extension(i));
}

ProtocolWatch::Passage* ProtocolWatch::find(const tlm::tlm_generic_payload& payload,
                                            const ProtocolChecker* hop) {
  const auto found = under_way_.find(&payload);
  if (found == under_way_.end()) return nullptr;
  for (Passage& passage : found->second)
    if (passage.hop == hop) return &passage;
  return nullptr;
}

ProtocolWatch::Passage* ProtocolWatch::before(const tlm::tlm_generic_payload& payload,
                                              const Passage& passage) {
  Passage* last = nullptr;
  for (Passage& each : path(payload)) {
    if (&each == &passage) return last;
    last = &each;
  }
  return nullptr;
}

void ProtocolWatch::end(const tlm::tlm_generic_payload& payload, const Passage* passage) {
  const auto found = under_way_.find(&payload);
  if (found == under_way_.end()) return;
  found->second.remove_if([&](const Passage& each) { return &each == passage; });
  if (found->second.empty()) under_way_.erase(found);
}

void ProtocolWatch::report(const ProtocolViolation& violation) {
  ++violations_;
  if (violated.watched()) return violated(violation);
  SC_REPORT_WARNING("/capsoc/protocol", violation.text.c_str());
}

}  // namespace capsoc::kit
