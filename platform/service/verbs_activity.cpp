// What the processor did lately.
#include <algorithm>
#include <cmath>

#include "service/board_verbs.h"

namespace capsoc::service {
namespace {

Answer activity(Board& board, const Call& call) {
  constexpr double ps_in_second = 1e12;
  const double window_ps = std::round(call.number("window_s") * ps_in_second);
  if (window_ps == 0) {
    board.activity().end();
    return {};
  }
  const auto& windows = ActivityRecord::windows;
  const auto found = std::find_if(windows.begin(), windows.end(), [window_ps](uint64_t each) {
    return static_cast<double>(each) == window_ps;
  });
  if (found == windows.end())
    return refuse("processor.activity: window_s is 0.001, 0.01, 0.1, 1, 10 or 100; 0 ends it",
                  Code::wrong_parameter);
  board.activity().begin(static_cast<std::size_t>(found - windows.begin()));
  return board.activity().read();
}

}  // namespace

std::vector<BoardVerb> activity_verbs() {
  return {
      {{"processor.activity",
        "When the processor slept and which handlers ran, up to now. It is recorded in bounded "
        "memory, from the first call on. After going back the window before the position is there, "
        "too, unless the way through it has more than 20 million instructions.",
        {need("window_s", Type::number,
              "how long: 0.001, 0.01, 0.1, 1, 10 or 100; 0 ends the recording")},
        {{"begin_ps", "integer", "of the window"},
         {"end_ps", "integer", "now"},
         {"known_ps", "integer", "where in the window the record begins"},
         {"bin_ps", "integer", "the width of one of 250 bins"},
         {"rows", "list",
          "of objects: name (asleep, thread, or that of the exception), exception (its number; "
          "null), share (of the known time), begun (times in the window). A handler lasts from its "
          "entry to its return with all that preempts it. Then slices, begin and duration of each "
          "in ps; or, if there are more than 600, shares: 255ths of each bin, at least 1 if there "
          "is any"}}},
       activity,
       Effect::looks},
  };
}

}  // namespace capsoc::service
