// Recordings in MAT files.
#pragma once

#include <string>
#include <string_view>

#include "base/result.h"
#include "sensor/column_table.h"

namespace capsoc::sensor {

/// Whether bytes begin as a MAT file of level 5 does (MATLAB's -v6 and -v7, scipy.io.savemat).
bool is_mat(std::string_view bytes);

/// The numeric vectors of a MAT file of level 5 as columns with their names, or the columns of its
/// only matrix; a scalar fs, Fs, rate_hz or sample_rate_hz is the sample rate. Compressed variables
/// are unpacked, at most a gigabyte of them. Error: one sentence with the file; the file of level
/// 7.3 (HDF5) is refused by it. Source of the format: MathWorks, MAT-File Format.
Result<ColumnTable> read_mat(std::string_view bytes, const std::string& file);

}  // namespace capsoc::sensor
