// A kind of work: what one run of a campaign does.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "campaign/axis.h"

namespace capsoc::campaign {

/// The description of a run, which identifies it and allows to repeat it.
struct Job {
  std::string identity;  ///< settings and hashes of input files; not where these lie
  std::string command;
};

/// Where a run leaves more than its result.
struct Keep {
  std::string stem;     ///< folder and name without an ending; "": nowhere
  bool failed = false;  ///< the run is known to fail: it is repeated to be recorded
  bool waves = false;   ///< record these, too
  std::optional<double> session_s = {};  ///< of a failed run: its session instead, of the last
                                         ///< simulated seconds; 0: of all
};

class Work {
 public:
  virtual ~Work() = default;
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;

  /// The cheap checks: every setting exists, is one of this kind and can have its value.
  virtual Result<Job> prepare(const std::vector<Assignment>& assignments) = 0;
  /// Whether a failed run can be written as a session.
  virtual bool has_sessions() const { return false; }
  /// The rest, with all input files read.
  virtual std::optional<Error> check(const std::vector<Assignment>& assignments,
                                     const Keep& keep) = 0;
  /// In its own process. Error: an input is wrong after all.
  virtual Result<nlohmann::ordered_json> perform(const std::vector<Assignment>& assignments,
                                                 const Keep& keep) = 0;
  /// A result that has every key that one can have.
  virtual nlohmann::ordered_json example() const = 0;
  /// Keys of results that are the host's matter, with all below them: never the same twice, and
  /// no metrics.
  virtual const std::vector<std::string>& host_keys() const = 0;

 protected:
  Work() = default;
};

/// `settings`: those of every run. Error: the end of a sentence that names the kinds there are.
Result<std::unique_ptr<Work>> make_work(const std::string& kind,
                                        const std::vector<Assignment>& settings);

}  // namespace capsoc::campaign
