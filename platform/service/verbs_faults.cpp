// Faults that are injected on the way.
#include <fmt/format.h>

#include "base/printable.h"
#include "inject/fault.h"
#include "service/board_verbs.h"

namespace capsoc::service {
namespace {

Answer inject_fault(Board& board, const Call& call) {
  const std::string line = call.text("fault");
  const inject::When now{inject::When::Unit::time, sc_core::sc_time_stamp().value(), 0};
  auto fault = inject::parse_fault(line, now);
  std::optional<Error> error;
  if (!fault) error = Error{fault.error()};
  Answer answer;
  if (fault) answer.result["fault"] = inject::to_text(fault.value());
  if (fault) error = board.simulation().inject(std::move(fault.value()));
  if (error) return refuse(fmt::format("fault.inject '{}': {}", printable(line, 120), error->text));
  return answer;
}

Answer list_injected(Board& board, const Call&) {
  Answer answer;
  Json& faults = answer.result["faults"] = Json::array();
  for (const run::FaultOutcome& fault : board.simulation().injected())
    faults.push_back(run::to_json(fault));
  return answer;
}

Answer list_places(Board& board, const Call&) {
  Answer answer;
  Json& places = answer.result["places"] = Json::array();
  for (const inject::ListedPlace& place : board.simulation().fault_places())
    places.push_back(inject::to_json(place));
  return answer;
}

}  // namespace

std::vector<BoardVerb> fault_verbs() {
  return {
      {{"fault.inject",
        "Injects a fault of the hardware. Until it is over, nothing can be saved, cloned or kept "
        "for going back.",
        {need("fault", Type::text,
              "as `capsoc run --inject` takes it: WHAT PLACE at WHEN [for SECONDS]; without \"at "
              "WHEN\" it begins now")},
        {{"fault", "text", "the same with its time"}}},
       inject_fault,
       Effect::input},
      {{"fault.list",
        "Returns the outcomes of the faults that were injected in this simulation.",
        {},
        {{"faults", "list",
          "of objects, as `faults` of a result has them: fault, applied; of one that was applied "
          "time_s, cycle, instruction, before, after, changes"}}},
       list_injected,
       Effect::looks_after_the_end},
      {{"fault.places",
        "What a fault can change: registers, memories that programs fill, devices, the "
        "coprocessor's state, flip-flops of the RTL.",
        {},
        {{"places", "list", "of objects: place, bits, unit"}}},
       list_places,
       Effect::looks},
  };
}

}  // namespace capsoc::service
