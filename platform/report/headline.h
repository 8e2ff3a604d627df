// What a report says first: its answer in a sentence, and the figures that it rests on.
#pragma once

#include <string>
#include <vector>

#include "report/result_file.h"

namespace capsoc::report {

struct Headline {
  /// A figure with the digits that mean something, its unit, and all of its digits.
  struct Figure {
    std::string label, value, exact;
  };
  const char* style = "";  ///< "good", "bad", "odd"
  std::string sentence;    ///< "": there is none in the result
  std::vector<Figure> figures;
};

/// Of a result of any command, in the words of its text on the terminal.
Headline headline_of(const Json& result);

}  // namespace capsoc::report
