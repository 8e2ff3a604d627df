// A store with what is needed to understand its rows.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "base/result.h"
#include "campaign/judge.h"
#include "campaign/store.h"
#include "campaign/work.h"

namespace capsoc::campaign {

struct StoredCampaign {
  StoredPlan plan;
  Description description;
  std::unique_ptr<Work> work;
  std::unique_ptr<Judge> judge;

  /// Error: there is no plan in it, or one that this program does not understand.
  static Result<StoredCampaign> of(const Store& store);

  /// Every run of the plan that is done, judged.
  using Take = std::function<void(const StoredRun& run, const Judged& judged)>;
  std::optional<Error> each_done(const Store& store, const Take& take) const;
};

}  // namespace capsoc::campaign
