#include "campaign/work.h"

#include "campaign/kinds.h"
#include "support/printable.h"

namespace capsoc::campaign {

Result<std::unique_ptr<Work>> make_work(const std::string& kind) {
  if (kind == "run") return make_run_work();
  if (kind == "fit") return make_fit_work();
  if (kind == "regress") return make_regress_work();
  return Error{"there is no kind '" + printable(kind) +
               "' of work; write kind = \"run\", \"fit\" or \"regress\""};
}

}  // namespace capsoc::campaign
