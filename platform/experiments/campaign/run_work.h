// `capsoc run` as a kind of work.
#pragma once

#include "campaign/work.h"

namespace capsoc::campaign {

class RunWork final : public Work {
 public:
  Result<Job> prepare(const std::vector<Assignment>& assignments) override;
  std::optional<Error> check(const std::vector<Assignment>& assignments, const Keep& keep) override;
  Result<nlohmann::ordered_json> perform(const std::vector<Assignment>& assignments,
                                         const Keep& keep) override;
  nlohmann::ordered_json example() const override;
  const std::vector<std::string>& host_keys() const override;
};

}  // namespace capsoc::campaign
