#include "bus/apb_bridge.h"

#include <algorithm>
#include <array>
#include <utility>

#include "bus/payload.h"
#include "bus/wait_states.h"
#include "kit/direct_route.h"
#include "kit/early_write.h"
#include "kit/steady_read.h"

namespace capsoc::bus {
namespace {

constexpr unsigned word = 4;
using Word = std::array<unsigned char, word>;

AddressMap apb_entries(const AddressMap& map) {
  AddressMap entries;
  for (const MapEntry& entry : map)
    if (entry.bus == BusKind::apb) entries.push_back(entry);
  return entries;
}

bool is_plain_word(const tlm::tlm_generic_payload& payload) {
  return payload.get_data_length() == word && payload.get_byte_enable_ptr() == nullptr &&
         payload.get_streaming_width() == word;
}

/// PSLVERR has one kind; that nothing answers is another matter.
tlm::tlm_response_status as_on_ahb(tlm::tlm_response_status status) {
  return status > tlm::TLM_INCOMPLETE_RESPONSE || status == tlm::TLM_ADDRESS_ERROR_RESPONSE
             ? status
             : tlm::TLM_GENERIC_ERROR_RESPONSE;
}

void prepare(tlm::tlm_generic_payload& payload, tlm::tlm_command command, uint64_t address,
             Word& data) {
  payload.set_command(command);
  payload.set_address(address);
  payload.set_data_ptr(data.data());
  payload.set_data_length(word);
  payload.set_streaming_width(word);
  payload.set_dmi_allowed(false);
  payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
}

// Lengths and alignments of AHB transfers: 1, 2, 4 bytes, or words one after another.
tlm::tlm_response_status check_transfer(const tlm::tlm_generic_payload& payload) {
  const tlm::tlm_response_status attributes = check_attributes(payload);
  if (attributes != tlm::TLM_OK_RESPONSE) return attributes;
  const unsigned length = payload.get_data_length();
  if (payload.get_streaming_width() < length) return tlm::TLM_BURST_ERROR_RESPONSE;
  if (length != 1 && length != 2 && length % word != 0) return tlm::TLM_BURST_ERROR_RESPONSE;
  const unsigned alignment = std::min(length, word);
  if (payload.get_address() % alignment != 0) return tlm::TLM_ADDRESS_ERROR_RESPONSE;
  return tlm::TLM_OK_RESPONSE;
}

}  // namespace

/// One APB transfer: a payload that is the bridge's while this lives.
class ApbBridge::Transfer {
 public:
  Transfer(ApbBridge& bridge, const tlm::tlm_generic_payload& of, uint64_t address, Word& data)
      : spare_(bridge.spare_) {
    if (spare_.empty()) {
      payload_ = std::make_unique<tlm::tlm_generic_payload>();
    } else {
      payload_ = std::move(spare_.back());
      spare_.pop_back();
    }
    prepare(*payload_, of.get_command(), address, data);
    payload_->set_extension(of.get_extension<kit::SteadyRead>());
    if (of.get_data_length() > word) return;  // of a burst, what came before would be done
    payload_->set_extension(of.get_extension<kit::EarlyWrite>());
    payload_->set_extension(of.get_extension<kit::DirectRoute>());
  }
  ~Transfer() {
    payload_->clear_extension<kit::SteadyRead>();  // they are the initiator's
    payload_->clear_extension<kit::EarlyWrite>();
    payload_->clear_extension<kit::DirectRoute>();
    payload_->set_byte_enable_ptr(nullptr);
    spare_.push_back(std::move(payload_));
  }
  Transfer(const Transfer&) = delete;
  Transfer& operator=(const Transfer&) = delete;

  tlm::tlm_generic_payload& operator*() { return *payload_; }
  tlm::tlm_generic_payload* operator->() { return payload_.get(); }

 private:
  std::vector<std::unique_ptr<tlm::tlm_generic_payload>>& spare_;
  std::unique_ptr<tlm::tlm_generic_payload> payload_;
};

ApbBridge::ApbBridge(const sc_core::sc_module_name& name, const AddressMap& map,
                     const kit::ClockDomain& clock)
    : sc_module(name), socket("socket"), decoder_(apb_entries(map)), clock_(clock) {
  socket.register_b_transport(this, &ApbBridge::b_transport);
  socket.register_transport_dbg(this, &ApbBridge::transport_dbg);
  if (!error().empty()) return;
  for (const MapEntry& entry : decoder_.map()) {
    const auto known = std::find_if(ports_.begin(), ports_.end(),
                                    [&](const Port& p) { return p.target == entry.target; });
    port_of_entry_.push_back(static_cast<std::size_t>(known - ports_.begin()));
    if (known == ports_.end())
      ports_.push_back(
          {entry.target, std::make_unique<InitiatorSocket>(("to_" + entry.target).c_str())});
  }
}

ApbBridge::InitiatorSocket* ApbBridge::port(const std::string& target) {
  for (Port& port : ports_)
    if (port.target == target) return port.socket.get();
  return nullptr;
}

std::vector<std::string> ApbBridge::targets() const {
  std::vector<std::string> names;
  for (const Port& port : ports_) names.push_back(port.target);
  return names;
}

void ApbBridge::b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
  tlm::tlm_response_status status = check_transfer(payload);
  if (status == tlm::TLM_OK_RESPONSE) status = transfer(payload, delay);
  if (status != tlm::TLM_OK_RESPONSE) add_cycles(clock_, error_response_cycles, delay);
  payload.set_response_status(status);
}

tlm::tlm_response_status ApbBridge::transfer(tlm::tlm_generic_payload& payload,
                                             sc_core::sc_time& delay) {
  const uint64_t end = payload.get_address() + payload.get_data_length();
  for (uint64_t at = payload.get_address() & ~uint64_t{word - 1}; at < end; at += word) {
    const Decoded where = decoder_.decode(at);
    if (where.entry == nullptr) return tlm::TLM_ADDRESS_ERROR_RESPONSE;
    if (payload.get_command() == tlm::TLM_IGNORE_COMMAND) continue;
    const tlm::tlm_response_status status = is_plain_word(payload)
                                                ? transfer_plain(payload, where, delay)
                                                : transfer_word(payload, where, at, delay);
    if (status != tlm::TLM_OK_RESPONSE) return status;
  }
  return tlm::TLM_OK_RESPONSE;
}

void ApbBridge::describe_route(tlm::tlm_generic_payload& transfer, const Decoded& at) {
  auto* const route = transfer.get_extension<kit::DirectRoute>();
  if (route == nullptr || route->target == nullptr) return;
  route->extend(ports_[port_of_entry_[at.index]].socket->operator->(),
                socket.get_base_export().operator->(), apb_transfer_cycles + at.entry->wait_states);
}

/// What nearly all transfers are: a word with all its bytes.
tlm::tlm_response_status ApbBridge::transfer_plain(tlm::tlm_generic_payload& payload,
                                                   const Decoded& at, sc_core::sc_time& delay) {
  Word data;
  std::copy_n(payload.get_data_ptr(), word, data.data());
  Transfer transfer(*this, payload, at.local, data);
  (*ports_[port_of_entry_[at.index]].socket)->b_transport(*transfer, delay);
  add_cycles(clock_, apb_transfer_cycles + at.entry->wait_states, delay);
  if (!transfer->is_response_ok()) return as_on_ahb(transfer->get_response_status());
  describe_route(*transfer, at);
  if (payload.is_read()) std::copy_n(data.data(), word, payload.get_data_ptr());
  return tlm::TLM_OK_RESPONSE;
}

tlm::tlm_response_status ApbBridge::transfer_word(tlm::tlm_generic_payload& payload,
                                                  const Decoded& at, uint64_t bus_word,
                                                  sc_core::sc_time& delay) {
  Word data{};
  Word strobes{};
  std::array<unsigned, word> source{};  // index into the payload's data of each strobed lane
  unsigned strobed = 0;
  for (unsigned lane = 0; lane < word; ++lane) {
    const uint64_t i = bus_word + lane - payload.get_address();  // wraps below the first byte
    if (i >= payload.get_data_length() || !byte_enabled(payload, static_cast<unsigned>(i)))
      continue;
    source[lane] = static_cast<unsigned>(i);
    data[lane] = payload.get_data_ptr()[i];
    strobes[lane] = TLM_BYTE_ENABLED;
    ++strobed;
  }
  Transfer transfer(*this, payload, at.local, data);
  if (payload.is_write() && strobed < word) {
    transfer->set_byte_enable_ptr(strobes.data());
    transfer->set_byte_enable_length(word);
  }
  (*ports_[port_of_entry_[at.index]].socket)->b_transport(*transfer, delay);
  add_cycles(clock_, apb_transfer_cycles + at.entry->wait_states, delay);
  if (!transfer->is_response_ok()) return as_on_ahb(transfer->get_response_status());
  describe_route(*transfer, at);
  if (payload.is_read())
    for (unsigned lane = 0; lane < word; ++lane)
      if (strobes[lane] == TLM_BYTE_ENABLED) payload.get_data_ptr()[source[lane]] = data[lane];
  return tlm::TLM_OK_RESPONSE;
}

unsigned ApbBridge::transport_dbg(tlm::tlm_generic_payload& payload) {
  // Word by word where a whole word is asked for; a debugger's odd bytes by read-modify-write.
  const unsigned length = payload.get_data_length();
  unsigned done = 0;
  if (payload.get_data_ptr() == nullptr || payload.get_command() == tlm::TLM_IGNORE_COMMAND)
    return 0;
  while (done < length) {
    const uint64_t address = payload.get_address() + done;
    const auto lane = static_cast<unsigned>(address % word);
    const unsigned part = std::min(word - lane, length - done);
    if (!debug_word(address - lane, lane, part, payload.is_write(), payload.get_data_ptr() + done))
      break;
    done += part;
  }
  return done;
}

bool ApbBridge::debug_word(uint64_t address, unsigned lane, unsigned count, bool write,
                           unsigned char* bytes) {
  const Decoded at = decoder_.decode(address);
  if (at.entry == nullptr) return false;
  InitiatorSocket& target = *ports_[port_of_entry_[at.index]].socket;
  Word data{};
  if (!write || count < word) {
    tlm::tlm_generic_payload read;
    prepare(read, tlm::TLM_READ_COMMAND, at.local, data);
    if (target->transport_dbg(read) != word) return false;
  }
  if (!write) {
    std::copy_n(data.data() + lane, count, bytes);
    return true;
  }
  std::copy_n(bytes, count, data.data() + lane);
  tlm::tlm_generic_payload store;
  prepare(store, tlm::TLM_WRITE_COMMAND, at.local, data);
  return target->transport_dbg(store) == word;
}

}  // namespace capsoc::bus
