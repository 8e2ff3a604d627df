// Where a simulation is in its history. Going back is done by the session (session_history.cpp).
#include <algorithm>
#include <utility>
#include <vector>

#include "host/files.h"
#include "host/sha256.h"
#include "service/board_verbs.h"
#include "service/recording.h"

namespace capsoc::service {
namespace {

Answer when(Board& board, const Call& call) {
  Answer answer;
  answer.result["now"] = to_json(board.position());
  const History& history = board.history();
  answer.result["kept"] = history.is_on();
  if (history.is_on()) {
    answer.result["beginning"] = to_json(history.beginning());
    answer.result["end"] = to_json(history.end());
    answer.result["history"] = history.number();
    answer.result["inputs"] = history.inputs().size();
    answer.result["snapshots"] = history.snapshots().size();
    answer.result["bytes"] = history.bytes();
  } else {
    answer.result["why"] = board.no_history();
  }
  if (!call.has("hash") || !call.boolean("hash")) return answer;
  const auto state = board.simulation().packed_state();
  if (!state) return refuse(state.error());
  answer.result["sha256"] = host::sha256_of(state.value());
  return answer;
}

Answer list(Board& board, const Call&) {
  const History& history = board.history();
  if (!history.is_on()) return refuse("there is no history: " + board.no_history());
  std::vector<std::pair<uint64_t, Json>> all = {
      {history.number(),
       {{"present", true}, {"end", to_json(history.end())}, {"inputs", history.inputs().size()}}}};
  for (const History::Left& left : history.left())
    all.emplace_back(left.number, Json{{"present", false},
                                       {"from", to_json(left.from)},
                                       {"end", to_json(left.end)},
                                       {"inputs", left.inputs.size()}});
  std::sort(all.begin(), all.end(),
            [](const auto& one, const auto& other) { return one.first < other.first; });
  Answer answer;
  Json& list = answer.result["histories"] = Json::array();
  for (auto& [number, about] : all) {
    Json each = {{"history", number}};
    each.update(about);
    list.push_back(std::move(each));
  }
  return answer;
}

Answer keep(Board& board, const Call&) {
  if (!board.history().is_on()) return refuse("there is no history: " + board.no_history());
  if (auto error = board.keep()) return refuse(error->text);
  return {};
}

Answer write_session(Board& board, const Call& call) {
  const std::string file = call.text("file");
  std::optional<double> last_s;
  if (call.has("last_s")) last_s = call.number("last_s");
  const auto session = record(board, last_s);
  if (!session) return refuse("simulation.record: " + session.error());
  if (auto error = board.check_files({{host::FileUse::Kind::output, "simulation.record", file}}))
    return refuse(error->text);
  const std::string bytes = pack(session.value());
  if (bytes.size() > SessionFile::largest)
    return refuse("simulation.record: the session has more than 1 GiB; record a shorter one");
  if (auto error = host::write_whole(file, bytes)) return refuse(error->text);
  Answer answer;
  answer.result = {{"bytes", bytes.size()},
                   {"from_s", static_cast<double>(session.value().begin_ps) * 1e-12},
                   {"inputs", session.value().inputs.size()},
                   {"marks", session.value().marks.size()}};
  return answer;
}

}  // namespace

std::vector<BoardVerb> history_verbs() {
  return {
      {{"history.when",
        "Where the simulation is in its history. A position has time_s, time_ps, cycles, "
        "instructions and samples.",
        {may("hash", Type::boolean, "with the hash of the whole state")},
        {{"now", "object", "the position of the simulation"},
         {"kept", "boolean", "whether there is a history"},
         {"why", "text", "there is none"},
         {"beginning", "object", "the first position that can be reached"},
         {"end", "object", "the last one that was reached"},
         {"history", "integer", "its number; a request that changes the past begins another one"},
         {"inputs", "integer", "requests that changed the simulation, since the beginning"},
         {"snapshots", "integer", "kept to go back to"},
         {"bytes", "integer", "that inputs and snapshots take; history_mb limits them"},
         {"sha256", "text", "of the state, equal for equal states of one program and settings"}}},
       when,
       Effect::looks},
      {{"history.list",
        "The present history, and those that were left when a request changed their past.",
        {},
        {{"histories", "list",
          "of objects: history (its number), present, end, inputs; of those that were left also "
          "from, the last position that they have in common with the present one"}}},
       list,
       Effect::looks},
      {{"history.keep",
        "Keeps a snapshot of now in the history, from where later positions are reached quickly. "
        "Some are kept without it.",
        {},
        {}},
       keep,
       Effect::looks},
      {{"simulation.record",
        "Writes the session of this simulation until now to a file that `capsoc replay` simulates "
        "again. It has settings, the program and the sensor by content, every request that changed "
        "the "
        "simulation with its instant, and hashes of the state on the way and at the end.",
        {need("file", Type::text, "its path"),
         may("last_s", Type::number,
             "simulated seconds: the session begins at the last snapshot of the history that is at "
             "least as long ago; else at the beginning of the history")},
        {{"bytes", "integer", "of the file"},
         {"from_s", "number", "where the session begins"},
         {"inputs", "integer", "requests in it"},
         {"marks", "integer", "positions whose state a replay compares"}}},
       write_session,
       Effect::looks},
  };
}

}  // namespace capsoc::service
