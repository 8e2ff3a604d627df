// Time: continuing, where it is, the end, the state in a file.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <utility>
#include <vector>

#include "host/child_process.h"
#include "service/advance.h"
#include "service/board_verbs.h"

namespace capsoc::service {
namespace {

Answer advance(Board& board, const Call& call) {
  return Advance(board, call).perform();
}

Answer state(Board& board, const Call&) {
  Answer answer;
  answer.result["state"] = board.state();
  if (!board.is_finished()) answer.result["place"] = board.simulation().view().here();
  return answer;
}

Answer finish(Board& board, const Call&) {
  Answer answer;
  answer.result = board.finish();
  return answer;
}

/// In a process apart, so that this one can continue.
Answer outcome(Board& board, const Call&) {
  if (!board.history().is_on())
    return refuse("simulation.outcome: there is no history: " + board.no_history());
  const host::Apart apart = host::perform_apart([&board] {
    spdlog::set_level(spdlog::level::off);
    return to_bytes(Message{board.finish(), {}});
  });
  if (apart.end == host::Apart::End::not_started)
    return refuse("simulation.outcome: no process can be started");
  MessageReader reader;
  reader.feed(apart.text);
  auto incoming = reader.next();
  if (!incoming || !incoming->message) return refuse("simulation.outcome: its process crashed");
  Answer answer;
  answer.result = std::move(incoming->message->body);
  return answer;
}

Answer save(Board& board, const Call& call) {
  if (const std::string why = board.beside_the_checkpoint(); !why.empty())
    return refuse(
        fmt::format("simulation.save: {}, which a file does not hold; take a snapshot", why));
  const std::string file = call.text("file");
  if (auto error = board.check_files({{host::FileUse::Kind::output, "simulation.save", file}}))
    return refuse(error->text);
  if (auto error = board.simulation().save(file)) return refuse(error->text);
  return {};
}

}  // namespace

std::vector<BoardVerb> advance_verbs() {
  const Member state_member{
      "state", "object",
      "time_s, time_ps, cycles, instructions, samples, pc, asleep, over (it cannot advance)"};
  const std::vector<Member> end = {
      {"code", "integer", "the exit code of `capsoc run`"},
      {"reason", "text", "why it ended"},
      {"reports", "list", "of a crash, or a difference between model and RTL"},
      {"lost", "list", "a sentence for each output that is not whole"},
      {"table", "text", "what `capsoc run` prints at its end"},
      {"result", "object", "as `capsoc run --json` writes it (docs/reference/results.md)"}};
  return {
      {{"simulation.advance",
        "Simulates until one goal is reached, between two instructions; without a goal to the end "
        "of the run.",
        {may("seconds", Type::number, "so long"), may("until_s", Type::number, "up to this time"),
         may("cycles", Type::integer, "this many cycles of the processor's clock"),
         may("instructions", Type::integer, "this many are executed"),
         may("samples", Type::integer, "this many results of the coprocessor are there"),
         may("address", Type::address, "in front of the instruction there, when it comes next"),
         may("exception", Type::any, "its handler is entered: a number, or a name as HardFault"),
         may("uart", Type::object,
             "uart (0 to 4) and pattern (RE2): what is unread matches, seen at the end of a line "
             "or of a burst"),
         may("expression", Type::object,
             "text (`turns > 3 and COPROCESSOR.STATUS.LOCK == 1`, $pc) is not 0, and every_s, how "
             "often to look: 1 ms of simulated time"),
         may("within_s", Type::number, "gives up after this many simulated seconds")},
        {state_member,
         {"reason", "text",
          "time, cycles, instructions, samples, address, exception, uart, expression; limit "
          "(within_s), interrupted, over; console (the program reads, see semihosting.send); bkpt "
          "(debugger.attach)"},
         {"match", "object", "of uart: text up to the match's end, groups"},
         {"events", "list", "those that events.subscribe asked for: kind, time_s, ..."}}},
       advance,
       Effect::looks},
      {{"simulation.state",
        "Where it is.",
        {},
        {state_member, {"place", "text", "the instruction under way, its line and who called"}}},
       state,
       Effect::looks_after_the_end},
      {{"simulation.finish",
        "Ends the run: outputs are written whole, and it has a result. Afterwards only state, "
        "samples and close may be asked.",
        {},
        end},
       finish,
       Effect::looks_after_the_end},
      {{"simulation.outcome",
        "What simulation.finish would answer here. Nothing ends, and the simulation can continue "
        "or go back; it has to have a history.",
        {},
        end},
       outcome,
       Effect::looks},
      {{"simulation.save",
        "Writes a checkpoint that `capsoc run --restore` takes, too.",
        {need("file", Type::text, "its path")},
        {}},
       save,
       Effect::looks},
  };
}

}  // namespace capsoc::service
