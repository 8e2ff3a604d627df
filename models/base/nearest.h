// The known names nearest to one that is not known, for error sentences.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace capsoc {

/// Levenshtein distance of two names.
inline unsigned edit_distance(std::string_view a, std::string_view b) {
  std::vector<unsigned> row(b.size() + 1);
  for (unsigned j = 0; j <= b.size(); ++j) row[j] = j;
  for (unsigned i = 1; i <= a.size(); ++i) {
    unsigned diagonal = row[0];
    row[0] = i;
    for (unsigned j = 1; j <= b.size(); ++j) {
      const unsigned substitute = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
    }
  }
  return row[b.size()];
}

/// Up to three known names, nearest first, joined by " or ".
inline std::string nearest_names(std::string_view wanted, std::vector<std::string> known) {
  std::stable_sort(known.begin(), known.end(), [&](const auto& a, const auto& b) {
    return edit_distance(wanted, a) < edit_distance(wanted, b);
  });
  std::string text;
  for (std::size_t i = 0; i < known.size() && i < 3; ++i) {
    if (i > 0) text += " or ";
    text += known[i];
  }
  return text;
}

}  // namespace capsoc
