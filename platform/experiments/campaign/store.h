// What a campaign has done so far: one SQLite file, one row a run. Killed at any moment it has all
// runs whose row was written, whole.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

#include "base/result.h"
#include "campaign/database.h"
#include "campaign/plan.h"
#include "campaign/store_place.h"

namespace capsoc::campaign {

/// A run that is done.
struct Row {
  std::string key;
  std::string ending;   ///< Ended::ending
  std::string command;  ///< that repeats it
  std::string result;   ///< JSON; "" for a worker that delivered none
  std::string log;
  double wall_s = 0;
};

/// A run of the store's plan, done or not.
struct StoredRun {
  uint64_t number = 0;              ///< in the plan
  std::vector<std::string> values;  ///< of the axes
  std::optional<Row> row;
};

/// The plan as a store keeps it.
struct StoredPlan {
  std::string description;        ///< the TOML text
  std::string file;               ///< where it was
  Program program;                ///< that did the runs
  std::vector<std::string> axes;  ///< paths
  uint64_t runs = 0;
};

class Store {
 public:
  /// Made if it is not there. It is locked against other campaigns until it is closed.
  static Result<std::unique_ptr<Store>> open(const std::string& path);
  /// Error: it is not there, or no store.
  static Result<std::unique_ptr<Store>> open_existing(const std::string& path);
  /// To look at it; while a campaign continues, too. It may be on a disk that is read-only, or has
  /// no locks and no shared memory.
  static Result<std::unique_ptr<Store>> read(const std::string& path);
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  const std::string& path() const { return path_; }
  /// Nothing in a new one, and in what a campaign leaves that was killed as it began.
  Result<std::optional<StoredPlan>> plan() const;
  /// The plan in place of the one there; rows stay.
  std::optional<Error> set_plan(const Plan& plan);
  Result<std::unordered_set<std::string>> keys() const;
  std::optional<Error> add(const std::vector<Row>& rows);
  /// Runs without a result are not done any more.
  std::optional<Error> forget_unfinished();
  /// All of the plan in its order; an Error of `take` ends it.
  std::optional<Error> each_run(
      const std::function<std::optional<Error>(const StoredRun&)>& take) const;
  /// The rows of another store of the same plan. How many of them were new.
  Result<uint64_t> merge(const Store& other);
  /// Adds a plan that another store has, to a new one.
  std::optional<Error> take_plan(const Store& other);

 private:
  Store() = default;
  static Result<std::unique_ptr<Store>> open(const std::string& path, Database::Mode mode);
  std::optional<Error> open_to_write(Database::Mode mode);
  std::optional<Error> open_to_read();
  std::optional<Error> open_database(const std::string& file, Database::Mode mode);
  std::optional<Error> leave_wal();
  std::optional<Error> lock();
  std::optional<Error> prepare(Database::Mode mode);

  std::string path_;
  std::unique_ptr<StoreCopy> copy_;  // what database_ is open on, if it is not the store itself
  bool begun_ = false;               // it has its tables
  bool shares_memory_ = true;
  int lock_ = -1;  // closed after the database: closing any descriptor drops SQLite's own locks
  std::unique_ptr<Database> database_;
};

}  // namespace capsoc::campaign
