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
  std::string verdict;     ///< a word or two that two results can agree in; "": there is none
  std::string sentence;    ///< "": there is none in the result
  std::vector<Figure> figures;
};

/// Of a result of any command, in the words of its text on the terminal.
Headline headline_of(const Json& result);

// Those of the commands that do many things at once.
Headline headline_of_campaign(const Json& result);
Headline headline_of_regress(const Json& result);
Headline headline_of_mutation(const Json& result);
Headline headline_of_reproduce(const Json& result);
Headline headline_of_accuracy(const Json& result);
Headline headline_of_bench(const Json& result);

}  // namespace capsoc::report
