// The runs of a store as a table: for spreadsheets, and for Python.
#pragma once

#include <string>

#include "base/result.h"
#include "campaign/store.h"

namespace capsoc::campaign {

struct ExportOptions {
  bool all_keys = false;  ///< every key of the results instead of the metrics
  bool times = false;     ///< what is the host's matter, too: never the same twice
};

/// A row a run that is done, in the order of the plan: run, key, ending, pass, the axes, metrics
/// and criteria.
Result<std::string> to_csv(const Store& store, const ExportOptions& options);
/// An object with a list for each column: pandas.DataFrame(json.load(file)) makes a table of it.
Result<std::string> to_columns(const Store& store, const ExportOptions& options);

}  // namespace capsoc::campaign
