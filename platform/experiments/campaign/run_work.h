// `capsoc run` as a kind of work.
#pragma once

#include <map>

#include "campaign/work.h"

namespace capsoc::campaign {

class RunWork final : public Work {
 public:
  Result<Job> prepare(const std::vector<Assignment>& assignments) override;
  std::optional<Error> check(const std::vector<Assignment>& assignments) override;
  Result<nlohmann::ordered_json> perform(const std::vector<Assignment>& assignments,
                                         const Keep& keep) override;
  nlohmann::ordered_json example() const override;
  const std::vector<std::string>& host_keys() const override;

 private:
  const std::string& hash_of(const std::string& file);

  std::map<std::string, std::string> hashes_;  // of input files, by path
};

}  // namespace capsoc::campaign
