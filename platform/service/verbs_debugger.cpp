// What a debugger asks for: the processor resumed with any number of points, a reset.
#include <algorithm>
#include <utility>

#include "service/advance.h"
#include "service/board_verbs.h"
#include "service/stop_points.h"

namespace capsoc::service {
namespace {

using debug::Resume;
using debug::StopCause;

/// How a request wants it to continue; nothing: no such way.
std::optional<Resume> resume_in(const Call& call) {
  const std::string kind = call.text("kind");
  if (kind == "run") return Resume{Resume::Kind::run};
  if (kind == "step") return Resume{Resume::Kind::step};
  if (kind != "range" || !call.has("start") || !call.has("end")) return std::nullopt;
  return Resume{Resume::Kind::range, static_cast<uint32_t>(call.integer("start")),
                static_cast<uint32_t>(call.integer("end"))};
}

/// Points that are set while it lives.
class Points {
 public:
  Points(Board& board, Json points) : board_(board), points_(std::move(points)) {
    error_ = set_points(board_, points_);
  }
  ~Points() {
    if (!error_) clear_points(board_, points_);
  }
  Points(const Points&) = delete;
  Points& operator=(const Points&) = delete;
  const std::optional<Error>& error() const { return error_; }

 private:
  Board& board_;
  Json points_;
  std::optional<Error> error_;
};

bool is_inside(const Resume& how, uint32_t pc) {
  return how.kind == Resume::Kind::range && pc >= how.range_start && pc < how.range_end;
}

Answer resume(Board& board, const Call& call) {
  if (board.is_finished() || board.simulation().is_over())
    return refuse("the simulation is over and cannot advance", Code::over);
  if (board.settings().gdb.port() >= 0)
    return refuse("debugger.resume: gdb.port gives the processor to another debugger");
  const auto how = resume_in(call);
  if (!how)
    return refuse("debugger.resume: kind is run, step, or range with a start and an end",
                  Code::wrong_parameter);
  const Points points(board, call.has("points") ? call.json("points") : Json::array());
  if (points.error()) return refuse(points.error()->text, Code::wrong_parameter);
  armv7m::Core& core = board.soc().cpu.core();
  const bool is_debugged = core.debugging().halting();
  // Where it stands is no arrival, if it has stopped there.
  if (!call.has("stopped") || call.boolean("stopped")) core.debugging().pass_breakpoint();
  core.debugging().set_halted(false);

  // The past ends where it went back from.
  std::optional<Position> end;
  if (board.history().is_on() && board.position() < board.history().end())
    end = board.history().end();
  std::optional<StopCause> cause;
  Advance advance(board);
  Advance::Watcher watcher;
  watcher.on_run = [&](armv7m::StopReason reason, bool advanced) {
    if (const auto stop = board.target().stop_cause(reason)) {
      if (stop->kind == StopCause::Kind::lockup && !is_debugged) return false;
      cause = stop;
      return true;
    }
    if (reason == armv7m::StopReason::semihosting_exit ||
        reason == armv7m::StopReason::semihosting_waits ||
        reason == armv7m::StopReason::reset_request)
      return false;
    if (how->kind == Resume::Kind::run || !advanced || is_inside(*how, core.reg(15))) return false;
    cause = StopCause{StopCause::Kind::step};
    return true;
  };
  advance.watch(std::move(watcher));
  const auto error = advance.resume(how->kind != Resume::Kind::run, end);
  core.debugging().set_halted(is_debugged);
  if (error) return refuse(error->text);
  Answer answer;
  if (cause)
    answer.result = to_json(*cause);
  else if (advance.hit() != nullptr)
    answer.result["reason"] = advance.hit();
  else if (advance.is_over())
    answer.result["reason"] = "over";
  else
    answer.result["reason"] = advance.is_interrupted() ? "interrupted" : "end";
  answer.result["state"] = board.state();
  answer.result["events"] = board.events().take();
  return answer;
}

Answer attach(Board& board, const Call& call) {
  board.soc().cpu.core().debugging().set_halting(call.boolean("attached"));
  board.soc().cpu.core().debugging().set_halted(call.boolean("attached"));
  return {};
}

Answer kill(Board& board, const Call&) {
  if (board.is_finished() || board.simulation().is_over()) return {};
  if (auto error = Advance(board).kill()) return refuse(error->text);
  return {};
}

Answer about(Board& board, const Call&) {
  Answer answer;
  answer.result["processor"] = board.target().processor();
  answer.result["state"] = board.target().state();
  Json& ranges = answer.result["memory"] = Json::array();
  for (const debug::MemoryRange& range : board.target().memory_ranges())
    ranges.push_back({range.start, range.length});
  return answer;
}

Answer reset(Board& board, const Call&) {
  board.target().reset();
  return {};
}

}  // namespace

std::vector<BoardVerb> debugger_verbs() {
  return {
      {{"debugger.attach",
        "A debugger attaches, which the program can see (DHCSR.C_DEBUGEN), or leaves. While one is "
        "attached, a BKPT stops in front of itself, and a lockup stops instead of ending the run.",
        {need("attached", Type::boolean, "or gone")},
        {}},
       attach,
       Effect::input},
      {{"debugger.resume",
        "The processor runs until it stops at a point, or has executed what was asked for. A "
        "breakpoint stops in front of its instruction, a watchpoint after the one that made the "
        "access. After going back it stops at the latest where it went back from.",
        {need("kind", Type::text, "run, step (one instruction) or range (while start <= pc < end)"),
         may("start", Type::integer, "of a range"), may("end", Type::integer, "of a range"),
         may("points", Type::any,
             "a list of objects: kind (breakpoint, hardware_breakpoint, write, read, access), "
             "address, size in bytes (4)"),
         may("stopped", Type::boolean,
             "true, unless it was interrupted and continues as if it was not: a breakpoint where "
             "it "
             "stands is passed")},
        {{"reason", "text",
          "breakpoint, bkpt, watchpoint, step, lockup; end (of the past), asleep (only a client "
          "can wake it), console (it reads, see semihosting.send), interrupted, over"},
         {"point", "text", "the kind of the point"},
         {"address", "integer", "of a watchpoint: what was accessed"},
         {"state", "object", "as simulation.state"},
         {"events", "list", "as simulation.advance"}}},
       resume,
       Effect::looks},
      {{"debugger.about",
        "What a debugger shows of the processor and its memory map.",
        {},
        {{"processor", "text", "cortex-m3, cortex-m0plus, cortex-m4 or cortex-m4f"},
         {"state", "text", "what the processor does, in words"},
         {"memory", "list", "of [start, length]: what can be read and written"}}},
       about,
       Effect::looks},
      {{"debugger.kill",
        "The run is over, ended by a debugger; simulation.finish says so.",
        {},
        {}},
       kill,
       Effect::looks},
      {{"processor.reset",
        "Resets the whole SoC as its reset line does; memories keep what they hold.",
        {},
        {}},
       reset,
       Effect::input},
  };
}

}  // namespace capsoc::service
