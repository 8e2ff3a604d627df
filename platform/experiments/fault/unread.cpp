#include "fault/unread.h"

#include <fmt/format.h>

#include <algorithm>
#include <systemc>

#include "coprocessor/register_map.h"
#include "inject/coprocessor_words.h"
#include "soc/register_index.h"
#include "trace/bus_trace.h"

namespace capsoc::fault {
namespace {

constexpr const char* table = "corrections.";

/// The correction's table by each of its names.
std::vector<std::string> places_of_table() {
  std::vector<std::string> places = {std::string("coprocessor.") + table};
  for (const inject::CoprocessorWord& word : inject::coprocessor_words())
    if (word.name.find(table) == 0) places.push_back("rtl." + word.flip_flop);
  return places;
}

double now_s() {
  return sc_core::sc_time_stamp().to_seconds();
}

}  // namespace

void Unread::visit(Archive& archive) {
  archive("places", places);
  archive("reason", reason);
}

bool Unread::has(const std::string& place) const {
  return std::any_of(places.begin(), places.end(), [&](const std::string& each) {
    return each.back() == '.' ? place.compare(0, each.size(), each) == 0 : place == each;
  });
}

UnreadWatch::UnreadWatch(run::Simulation& simulation) : from_s_(now_s()) {
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
  if (corrects_) return {};
  return {{places_of_table(),
           fmt::format("CTRL.CORRECT is 0 from {:.6g} s to {:.6g} s, so nothing reads the table",
                       from_s_, now_s())}};
}

std::string reason_not_read(const std::string& place, const std::vector<Unread>& unread) {
  for (const Unread& each : unread)
    if (each.has(place)) return each.reason;
  return "";
}

}  // namespace capsoc::fault
