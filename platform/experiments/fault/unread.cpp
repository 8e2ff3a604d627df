#include "fault/unread.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <systemc>

#include "coprocessor/register_map.h"
#include "inject/coprocessor_words.h"
#include "kit/seconds.h"
#include "soc/register_index.h"
#include "trace/bus_trace.h"

namespace capsoc::fault {
namespace {

constexpr const char* table = "corrections.";
constexpr const char* memory = "mem:";

/// The correction's table by each of its names.
std::vector<std::string> places_of_table() {
  std::vector<std::string> places = {std::string("coprocessor.") + table};
  for (const inject::CoprocessorWord& word : inject::coprocessor_words())
    if (word.name.find(table) == 0) places.push_back("rtl." + word.flip_flop);
  return places;
}

double now_s() {
  return kit::to_seconds(sc_core::sc_time_stamp());
}

}  // namespace

void Unread::visit(Archive& archive) {
  archive("places", places);
  archive("reason", reason);
  archive("used", used);
}

bool Unread::has(const std::string& place, unsigned bit) const {
  if (!used.empty() && used[bit / 32] != 0) return false;
  return std::any_of(places.begin(), places.end(), [&](const std::string& each) {
    return each.back() == '.' ? place.compare(0, each.size(), each) == 0 : place == each;
  });
}

MemoryUse::MemoryUse(soc::Soc& soc, const std::vector<inject::ListedPlace>& places) : soc_(soc) {
  for (const inject::ListedPlace& place : places) {
    if (place.name.rfind(memory, 0) != 0) continue;
    const std::string address = place.name.substr(std::string(memory).size());
    memories_.push_back({place.name,
                         static_cast<uint32_t>(std::strtoul(address.c_str(), nullptr, 0)),
                         std::string((place.bits + 31) / 32, 0)});
  }
  if (!memories_.empty()) soc_.cpu.core().add_observer(*this, true, true);
}

MemoryUse::~MemoryUse() {
  if (!memories_.empty()) soc_.cpu.core().remove_observer(*this);
}

void MemoryUse::use(uint32_t address, unsigned size) {
  for (Words& words : memories_)
    for (uint32_t byte = address; byte != address + size; ++byte)
      if (byte >= words.address && byte - words.address < 4 * words.used.size())
        words.used[(byte - words.address) / 4] = 1;
}

void MemoryUse::issued(const armv7m::Core&, const armv7m::DecodedOp& op) {
  use(op.address, op.size);
}

void MemoryUse::accessed(const armv7m::Core&, const armv7m::DirectAccess& access) {
  use(access.address, access.size);
}

std::vector<Unread> MemoryUse::unused(const std::string& span) const {
  std::vector<Unread> unused;
  for (const Words& words : memories_)
    unused.push_back(
        {{words.place}, fmt::format("the processor does not use the word {}", span), words.used});
  return unused;
}

UnreadWatch::UnreadWatch(run::Simulation& simulation,
                         const std::vector<inject::ListedPlace>& places)
    : from_s_(now_s()), memory_(simulation.soc(), places) {
  soc::Soc& soc = simulation.soc();
  const soc::RegisterIndex registers(soc);
  const auto ctrl = registers.find("COPROCESSOR.CTRL");
  if (!ctrl) {
    corrects_ = true;
    return;
  }
  ctrl_address_ = ctrl.value().reg->address;
  written(soc.peek(ctrl_address_));
  listening_ = soc.ahb.transfers.listen([this](const tlm::tlm_generic_payload& payload,
                                               const sc_core::sc_time&, const sc_core::sc_time&) {
    if (payload.is_write() && payload.get_address() / 4 == ctrl_address_ / 4)
      written(payload.get_data_length() < 4 ? ~0U : trace::data_word(payload));
  });
}

void UnreadWatch::written(uint32_t word) {
  if ((word & coprocessor::ctrl_correct) != 0) corrects_ = true;
}

std::vector<Unread> UnreadWatch::unread() const {
  const std::string span = fmt::format("from {:.6g} s to {:.6g} s", from_s_, now_s());
  std::vector<Unread> unread = memory_.unused(span);
  if (!corrects_)
    unread.push_back({places_of_table(),
                      fmt::format("CTRL.CORRECT is 0 {}, so nothing reads the table", span), ""});
  return unread;
}

std::string reason_not_read(const std::string& place, unsigned bit,
                            const std::vector<Unread>& unread) {
  for (const Unread& each : unread)
    if (each.has(place, bit)) return each.reason;
  return "";
}

}  // namespace capsoc::fault
