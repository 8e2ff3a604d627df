#pragma once

#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

#include "base/data_table.h"

namespace capsoc::accuracy {

/// Prints the coprocessor model's angle errors in degrees, `precise` and `paper` arithmetic side by
/// side: sensors beyond the SoC paper's, converter widths, a moving speed, a wrong reference. Every
/// random record has a fixed seed, so the text is the same on every run. Returns the number of rows
/// whose `precise` figures miss their bound or whose signal clips: 0 is the expected result.
/// `chosen`: only the tables with these ids of table_names, empty: all. `tables` takes the rows:
/// quantity, unit, precise, paper, bound (of precise), verdict ("holds", "misses", "clips" or "").
int print_accuracy(std::ostream& out, const std::vector<std::string>& chosen = {},
                   std::vector<DataTable>* tables = nullptr);

}  // namespace capsoc::accuracy
