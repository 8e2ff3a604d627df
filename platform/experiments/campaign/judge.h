// The metrics of a run, and whether it meets the criteria.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "campaign/description.h"
#include "campaign/store.h"
#include "campaign/work.h"

namespace capsoc::campaign {

struct Judged {
  bool finished = false;                       ///< there is a result
  std::vector<std::optional<double>> metrics;  ///< in the order of Judge::metrics()
  std::vector<bool> criteria;
  bool pass = false;            ///< all criteria are met; one without a value is not
  std::vector<std::string> by;  ///< values, in the order of Judge::by()
  std::string exit;             ///< "0: the firmware ended with status 0", or the worker's ending
};

class Judge {
 public:
  /// Without [metrics] these are all numbers of a result, without [criteria] there is the one that
  /// the exit code is 0.
  Judge(const Description& description, const Work& work, std::vector<std::string> axes);

  const std::vector<std::string>& axes() const { return axes_; }
  const std::vector<Named>& metrics() const { return metrics_; }
  const std::vector<Named>& criteria() const { return criteria_; }
  /// What the report tells apart.
  const std::vector<Named>& by() const { return by_; }
  /// The metric whose largest values are the worst; nothing without metrics.
  std::optional<std::size_t> worst() const { return worst_; }

  /// Error: the row is damaged.
  Result<Judged> judge(const std::vector<std::string>& values, const Row& row) const;

 private:
  std::vector<std::string> axes_;
  std::vector<Named> metrics_, criteria_, by_;
  std::optional<std::size_t> worst_;
};

}  // namespace capsoc::campaign
