// The tables of `capsoc accuracy`, by which the command, its results and their report name them.
#pragma once

#include <array>
#include <utility>

namespace capsoc::accuracy {

/// Ids and titles, in the order in which they are printed.
inline constexpr std::array<std::pair<const char*, const char*>, 7> table_names = {{
    {"sensors", "Sensors beyond the paper"},
    {"widths", "Converter width"},
    {"ripple", "Moving speed"},
    {"shuffled", "Random angles"},
    {"reference", "Wrong reference"},
    {"drift", "Parameters and speeds that move"},
    {"peers", "The methods that the papers name"},
}};

}  // namespace capsoc::accuracy
