// A recording as columns in memory, as binary files have it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "sensor/column_roles.h"
#include "sensor/recorded_source.h"
#include "sensor/recording_options.h"

namespace capsoc::sensor {

struct ColumnTable {
  std::vector<ColumnName> names;  ///< "1", "2", ... where `named` is not set
  std::vector<std::vector<double>> columns;
  bool named = true;
  bool channels = false;          ///< of a sound: only two of them tell by themselves what they are
  std::optional<double> rate_hz;  ///< where the file states it
  std::vector<std::string> remarks;  ///< sentences without the file's name
};

/// Chooses the columns and makes the source. Error: one sentence with the file.
Result<RecordedSource> read_table(const ColumnTable& table, const std::string& file,
                                  const RecordingOptions& options);

/// "1", "2", ... for columns without names.
std::vector<ColumnName> numbered_names(std::size_t count);

}  // namespace capsoc::sensor
