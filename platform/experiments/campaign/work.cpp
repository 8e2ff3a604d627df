#include "campaign/work.h"

#include "base/printable.h"
#include "campaign/kinds.h"

namespace capsoc::campaign {

Result<std::unique_ptr<Work>> make_work(const std::string& kind,
                                        const std::vector<Assignment>& settings) {
  if (kind == "run") return make_run_work();
  if (kind == "fit") return make_fit_work();
  if (kind == "regress") return make_regress_work();
  if (kind == "fault") return make_fault_work();
  if (kind == "command") return make_command_work(settings);
  return Error{"there is no kind '" + printable(kind) +
               "' of work; write kind = \"run\", \"fit\", \"regress\", \"fault\" or \"command\""};
}

}  // namespace capsoc::campaign
