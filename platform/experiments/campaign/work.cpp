#include "campaign/work.h"

#include "campaign/fit_work.h"
#include "campaign/regress_work.h"
#include "campaign/run_work.h"
#include "support/printable.h"

namespace capsoc::campaign {

Result<std::unique_ptr<Work>> make_work(const std::string& kind) {
  if (kind == "run") return std::unique_ptr<Work>(std::make_unique<RunWork>());
  if (kind == "fit") return std::unique_ptr<Work>(std::make_unique<FitWork>());
  if (kind == "regress") return std::unique_ptr<Work>(std::make_unique<RegressWork>());
  return Error{"there is no kind '" + printable(kind) +
               "' of work; write kind = \"run\", \"fit\" or \"regress\""};
}

}  // namespace capsoc::campaign
