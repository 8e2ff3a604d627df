#include "campaign/stored_campaign.h"

#include <utility>

namespace capsoc::campaign {

Result<StoredCampaign> StoredCampaign::of(const Store& store) {
  auto plan = store.plan();
  if (!plan) return Error{plan.error()};
  if (!plan.value())
    return Error{store.path() + ": holds no campaign yet; capsoc campaign run begins one"};
  auto description =
      read_description(plan.value()->description, store.path() + ": its description");
  if (!description) return Error{description.error()};
  auto work = make_work(description.value().kind, description.value().settings);
  if (!work) return Error{store.path() + ": " + work.error()};
  StoredCampaign campaign{std::move(*plan.value()), std::move(description.value()),
                          std::move(work.value()), nullptr};
  campaign.judge =
      std::make_unique<Judge>(campaign.description, *campaign.work, campaign.plan.axes);
  return campaign;
}

std::optional<Error> StoredCampaign::each_done(const Store& store, const Take& take) const {
  return store.each_run([&](const StoredRun& run) -> std::optional<Error> {
    if (!run.row) return std::nullopt;
    const auto judged = judge->judge(run.values, *run.row);
    if (!judged) return Error{store.path() + ": " + judged.error()};
    take(run, judged.value());
    return std::nullopt;
  });
}

}  // namespace capsoc::campaign
