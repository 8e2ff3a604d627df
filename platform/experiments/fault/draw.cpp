#include "fault/draw.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/printable.h"
#include "base/random.h"
#include "base/split.h"
#include "inject/fault.h"

namespace capsoc::fault {
namespace {

/// From a sample to its result, in clock cycles (docs/reference/coprocessor.md, "Time").
constexpr uint64_t pipeline_cycles = 162;

bool begins_with_one_of(const std::string& unit, const std::vector<std::string>& beginnings) {
  return std::any_of(beginnings.begin(), beginnings.end(), [&](const std::string& each) {
    return unit.compare(0, each.size(), each) == 0;
  });
}

std::vector<std::string> list_of(const std::string& text) {
  std::vector<std::string> list = split(text, ',');
  list.erase(std::remove(list.begin(), list.end(), ""), list.end());
  return list;
}

/// The last start whose `key` is below `value`; the first one if none is.
std::size_t start_before(const Golden& golden, uint64_t Start::*key, uint64_t value) {
  std::size_t found = 0;
  for (std::size_t i = 0; i < golden.starts.size(); ++i)
    if (golden.starts[i].*key < value) found = i;
  return found;
}

std::size_t start_for(const inject::When& when, const Golden& golden) {
  if (when.unit == inject::When::Unit::time)
    return start_before(golden, &Start::time_ps, when.value);
  if (when.unit == inject::When::Unit::sample)
    return start_before(golden, &Start::sample, when.value);
  return 0;
}

/// One that the settings name.
Result<Drawn> given(const std::string& line, const Golden& golden) {
  auto fault = inject::parse_fault(line);
  if (!fault) return Error{fmt::format("fault.line '{}': {}", printable(line, 120), fault.error())};
  Drawn drawn;
  drawn.place = fault.value().place;
  drawn.bit = fault.value().bit;
  for (const inject::ListedPlace& place : golden.places)
    if (place.name == drawn.place) drawn.unit = place.unit;
  drawn.line = inject::to_text(fault.value());
  drawn.start = start_for(fault.value().when, golden);
  return drawn;
}

}  // namespace

Result<Drawn> draw(const TrialSettings& settings, const Golden& golden) {
  if (!settings.line.empty()) return given(settings.line(), golden);
  const std::vector<std::string> units = list_of(settings.units());
  std::vector<const inject::ListedPlace*> places;
  uint64_t bits = 0;
  for (const inject::ListedPlace& place : golden.places)
    if (begins_with_one_of(place.unit, units)) {
      places.push_back(&place);
      bits += place.bits;
    }
  if (bits == 0)
    return Error{
        fmt::format("fault.units: no unit begins with '{}'; capsoc run "
                    "--list-fault-places names them",
                    printable(settings.units(), 120))};
  Random random(static_cast<uint64_t>(settings.seed()));
  uint64_t bit = random.below(bits);
  std::size_t which = 0;
  while (bit >= places[which]->bits) bit -= places[which++]->bits;
  inject::Fault fault;
  fault.kind = settings.kind();
  fault.place = places[which]->name;
  fault.bit = static_cast<unsigned>(bit);
  if (settings.pipeline()) {
    fault.when.unit = inject::When::Unit::sample;
    fault.when.value =
        random.between(golden.starts.front().sample + 1, golden.starts.back().sample + 1);
    fault.when.cycles = random.below(pipeline_cycles);
  } else {
    const double seconds =
        settings.from_s() + random.uniform() * (settings.to_s() - settings.from_s());
    // Whole microseconds, after the first start.
    const auto us = static_cast<uint64_t>(seconds * 1e6);
    fault.when.value = std::max(us * 1'000'000, golden.starts.front().time_ps + 1'000'000);
  }
  return Drawn{places[which]->unit, fault.place, fault.bit, inject::to_text(fault),
               start_for(fault.when, golden)};
}

}  // namespace capsoc::fault
