#include "service/board_verbs.h"

#include <iterator>

namespace capsoc::service {

const std::vector<BoardVerb>& board_verbs() {
  static const std::vector<BoardVerb> all = [] {
    std::vector<BoardVerb> verbs;
    for (auto of_subject :
         {advance_verbs(), memory_verbs(), register_verbs(), port_verbs(), sensor_verbs()})
      verbs.insert(verbs.end(), std::make_move_iterator(of_subject.begin()),
                   std::make_move_iterator(of_subject.end()));
    return verbs;
  }();
  return all;
}

}  // namespace capsoc::service
