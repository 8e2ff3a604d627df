#pragma once

#include <iosfwd>

namespace capsoc::accuracy {

/// Prints the coprocessor model's angle errors in degrees, `precise` and `paper` arithmetic side by
/// side: sensors beyond the SoC paper's, converter widths, a moving speed, a wrong reference. Every
/// random record has a fixed seed, so the text is the same on every run. Returns the number of rows
/// whose `precise` figures miss their bound or whose signal clips: 0 is the expected result.
int print_accuracy(std::ostream& out);

}  // namespace capsoc::accuracy
