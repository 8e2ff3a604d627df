#include "service/board_verbs.h"

#include <iterator>
#include <unordered_map>
#include <utility>

namespace capsoc::service {

const std::vector<BoardVerb>& board_verbs() {
  static const std::vector<BoardVerb> all = [] {
    std::vector<BoardVerb> verbs;
    for (auto of_subject :
         {advance_verbs(), history_verbs(), memory_verbs(), register_verbs(), port_verbs(),
          sensor_verbs(), fault_verbs(), debugger_verbs(), activity_verbs()})
      verbs.insert(verbs.end(), std::make_move_iterator(of_subject.begin()),
                   std::make_move_iterator(of_subject.end()));
    for (BoardVerb& verb : verbs)
      if (verb.effect == Effect::input)
        verb.about.result.push_back(
            {"ended_history", "object",
             "after going back: where the history ended that this request leaves, and its number, "
             "`history`"});
    return verbs;
  }();
  return all;
}

const BoardVerb* board_verb(const std::string& method) {
  static const std::unordered_map<std::string, const BoardVerb*> by_name = [] {
    std::unordered_map<std::string, const BoardVerb*> names;
    for (const BoardVerb& verb : board_verbs()) names[verb.about.method] = &verb;
    return names;
  }();
  const auto found = by_name.find(method);
  return found == by_name.end() ? nullptr : found->second;
}

Answer perform_input(Board& board, const BoardVerb& verb, const Call& call) {
  board.left_bkpt();
  return verb.perform(board, call);
}

std::optional<Error> apply_input(Board& board, const Input& input) {
  const BoardVerb* const verb = board_verb(input.method);
  if (verb == nullptr || verb->effect != Effect::input) return Error{input.method + " is no input"};
  const Call call(verb->about, input.parameters, input.frames);
  if (std::string complaint = call.complaint(); !complaint.empty())
    return Error{std::move(complaint)};
  perform_input(board, *verb, call);
  return std::nullopt;
}

}  // namespace capsoc::service
