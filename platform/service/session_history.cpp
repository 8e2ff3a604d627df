// Going back: a worker for a position in the past takes the place of the present one, or searches
// the past for it and ends. The simulation stands still meanwhile, and later requests wait.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string_view>
#include <utility>

#include "service/history.h"
#include "service/session_parts.h"

namespace capsoc::service {
namespace {

constexpr double ps_in_second = 1e12, latest_s = 1e6;
/// A change is looked for on finer and finer grids, down to this.
constexpr uint64_t finer = 1000, finest_ps = 1000;
/// What a request writes shows in a register of a device at one of the next edges of its clock.
constexpr uint64_t cycles_of_a_write = 2;
constexpr uint64_t near_instructions = 1'000'000;
/// How many stretches in which a register stays as it was before the rest of the part is observed.
constexpr unsigned most_in_vain = 4;

struct Named {
  const char* name;
  Unit unit;
};
constexpr Named positions[] = {{"time_s", Unit::time},
                               {"time_ps", Unit::time},
                               {"cycles", Unit::cycles},
                               {"instructions", Unit::instructions},
                               {"sample", Unit::samples}};
constexpr Named distances[] = {{"seconds", Unit::time},
                               {"cycles", Unit::cycles},
                               {"instructions", Unit::instructions},
                               {"samples", Unit::samples}};

/// One of the names as {"unit", "value"}; null: there is none, or more than one, or no such value.
template <std::size_t n>
Json goal_in(const Json& parameters, const Named (&names)[n]) {
  Json goal;
  for (const Named& each : names) {
    const auto found = parameters.find(each.name);
    if (found == parameters.end()) continue;
    if (!goal.is_null()) return nullptr;
    uint64_t value = 0;
    if (each.unit == Unit::time && std::string_view(each.name) != "time_ps") {
      if (!found->is_number()) return nullptr;
      const double seconds = found->get<double>();
      if (!(seconds >= 0 && seconds <= latest_s)) return nullptr;
      value = static_cast<uint64_t>(std::llround(seconds * ps_in_second));
    } else {
      if (!found->is_number_unsigned()) return nullptr;
      value = found->get<uint64_t>();
    }
    goal = to_json(Target{each.unit, value});
  }
  return goal;
}

constexpr const char* position_words =
    "a time_s (0 to 1e6) or time_ps, cycles, instructions or a sample";

/// How often to look, in ps; 0: wrong.
uint64_t step_in(const Json& parameters) {
  const auto every = parameters.find("every_s");
  if (every == parameters.end()) return static_cast<uint64_t>(1e-3 * ps_in_second);
  if (!every->is_number()) return 0;
  const double seconds = every->get<double>();
  if (!(seconds >= 1e-9 && seconds <= latest_s)) return 0;
  return static_cast<uint64_t>(std::llround(seconds * ps_in_second));
}

}  // namespace

/// Asks the worker for its history. `then`, unless the worker refused or went ahead itself.
void Session::seek(Request& request, Json leave,
                   std::function<void(Json, std::shared_ptr<Seek>)> then) {
  Simulation* const simulation = simulation_of(request);
  if (simulation == nullptr) return;
  ++clients_.at(request.client)->calls;
  simulation->is_replaced = true;
  simulation->is_interrupted = false;
  auto seek = std::make_shared<Seek>();
  seek->request = request;
  seek->simulation = simulation->number;
  seek->client = simulation->client;
  seek->settings = simulation->settings;
  seek->leave = leave;
  Simulation* const spare = spare_of(simulation->number);
  seek->is_whole = spare == nullptr || !spare->is_spare->is_ready;
  if (!seek->is_whole) leave["known"] = spare->is_spare->known;
  call(*simulation, leave_method, std::move(leave), {},
       [this, seek, then = std::move(then)](Answer answer) {
         if (!answer.ok() || !answer.result.contains("history")) {
           answer.result.erase("now");
           if (answer.ok() && answer.result.at("interrupted") == Json(true))
             answer =
                 refuse("the way there was interrupted; the simulation stands where it was then");
           answer.result.erase("interrupted");
           return end_seek(*seek, std::move(answer));
         }
         seek->history = std::move(answer.result.at("history"));
         seek->told = std::move(answer.result.at("told"));
         seek->may_be_forked = answer.result.at("may_be_forked").get<bool>();
         seek->frames = std::move(answer.frames);
         seek->now = position_in(answer.result.at("now")).value_or(Position());
         for (const Json& each : seek->history.at("snapshots"))
           seek->snapshots.push_back(position_in(each.at("at")).value_or(Position()));
         then(std::move(answer.result), seek);
       });
}

/// The requests that waited continue.
void Session::end_seek(const Seek& seek, Answer answer) {
  const auto found = simulations_.find(seek.simulation);
  std::deque<Request> waiting;
  if (found != simulations_.end()) {
    found->second->is_replaced = false;
    found->second->seeker = 0;
    waiting = std::exchange(found->second->waiting, {});
  }
  settle(seek.request, std::move(answer));
  resume(std::move(waiting));
}

/// A worker in the past; `done` gets its number.
void Session::start_past(const std::shared_ptr<Seek>& seek, uint64_t client, Json how,
                         Constructed done) {
  Start start{
      seek, client, std::move(how), [this, done = std::move(done)](uint64_t fresh, Answer answer) {
        if (answer.ok() && answer.result.value("interrupted", false)) {
          drop_worker(fresh);
          answer = refuse("the way there was interrupted; the simulation stays where it was");
        }
        done(fresh, std::move(answer));
      }};
  start_by_spare(std::move(start));
}

/// True, and it is answered: the simulation has ended, or wants no worker in the past any more.
bool Session::is_refused(const Start& start) {
  const auto found = simulations_.find(start.seek->simulation);
  if (found == simulations_.end())
    start.done(0, refuse(fmt::format("simulation {} has ended meanwhile", start.seek->simulation),
                         Code::no_simulation));
  else if (found->second->is_interrupted)
    start.done(0, refuse("the search was interrupted; the simulation stays where it was"));
  else
    return false;
  return true;
}

/// A worker that constructs its board itself.
void Session::start_alone(Start start) {
  if (is_refused(start)) return;
  const std::shared_ptr<Seek> seek = start.seek;
  if (!seek->is_whole) return ask_history(std::move(start), &Session::start_alone);
  start.how["history"] = seek->history;
  start_with(start.client, seek->settings, std::move(start.how), seek->frames,
             simulations_.at(seek->simulation)->files, std::move(start.done), seek->simulation);
  // Found again: starting one may have ended others.
  if (const auto still = simulations_.find(seek->simulation); still != simulations_.end())
    still->second->seeker = next_simulation_ - 1;
}

/// One that has no outputs.
void Session::drop_worker(uint64_t number) {
  const auto found = simulations_.find(number);
  if (found == simulations_.end()) return;
  found->second->worker.kill();
  ending_.push_back(std::move(found->second));
  simulations_.erase(found);
}

/// Asks one question of a worker in the past, which ends then.
void Session::ask_past(const std::shared_ptr<Seek>& seek, Json how, std::string method,
                       Json parameters, Frames frames, Take take) {
  how["for_good"] = true;
  start_past(
      seek, 0, std::move(how),
      [this, method = std::move(method), parameters = std::move(parameters),
       frames = std::move(frames), take = std::move(take)](uint64_t fresh, Answer answer) mutable {
        if (!answer.ok()) return take(std::move(answer));
        Simulation& past = *simulations_.at(fresh);
        past.is_constructed = false;  // no client knows of it
        call(past, method, std::move(parameters), std::move(frames),
             [this, fresh, take = std::move(take)](Answer came) {
               drop_worker(fresh);
               take(std::move(came));
             });
      });
}

/// The simulation itself goes to a position of the past.
void Session::replace(const std::shared_ptr<Seek>& seek, Json goal, Json more) {
  start_past(seek, seek->client, {{"goal", std::move(goal)}, {"told", seek->told}},
             [this, seek, more = std::move(more)](uint64_t fresh, Answer constructed) {
               if (constructed.ok()) {
                 constructed.result.erase("interrupted");
                 constructed.result.update(more);
               }
               finish_restore(seek->request, seek->simulation, fresh, std::move(constructed));
             });
}

/// Part after part of the history, the last one first. What is looked for at every instruction may
/// be near: the end of the last part comes before the rest of it, which is reached without a look.
void Session::search(const std::shared_ptr<Seek>& seek, std::size_t part) {
  const bool is_last =
      part + 1 >= seek->snapshots.size() || !(seek->snapshots[part + 1] < seek->now);
  const Position& end = is_last ? seek->now : seek->snapshots[part + 1];
  const bool everywhere = seek->what.contains("register") || seek->what.contains("write") ||
                          seek->what.contains("points");
  if (!is_last || !everywhere || !is_long(*seek, part, end)) return search_part(seek, part, end);
  const Target near{Unit::instructions, end.instructions - near_instructions};
  search_from(seek, {{"goal", to_json(near)}}, end, false,
              [this, seek, part](const Position& from) { search_part(seek, part, from); });
}

/// From the snapshot to `end` there is more than what is searched first.
bool Session::is_long(const Seek& seek, std::size_t part, const Position& end) {
  return seek.snapshots[part].instructions + near_instructions < end.instructions;
}

/// A part without what comes after `end`.
void Session::search_part(const std::shared_ptr<Seek>& seek, std::size_t part, const Position& end,
                          unsigned in_vain) {
  const bool narrows = seek->what.contains("register") && in_vain < most_in_vain;
  if (narrows && is_long(*seek, part, end)) return narrow(seek, part, end, in_vain);
  search_from(seek, {{"snapshot", part}}, end, part == 0,
              [this, seek, part](const Position&) { search_before(seek, part); });
}

/// What is before a part.
void Session::search_before(const std::shared_ptr<Seek>& seek, std::size_t part) {
  if (part > 0) return search(seek, part - 1);
  seek->found(*seek, {{"hit", nullptr}});
}

/// To observe a register takes long: only the last stretch of the part in which an instruction may
/// have changed it. It was in vain where all that wrote to the register wrote the value that it
/// had.
void Session::narrow(const std::shared_ptr<Seek>& seek, std::size_t part, const Position& end,
                     unsigned in_vain) {
  Json what = seek->what;
  what["narrow"] = true;
  ask_search(seek, {{"snapshot", part}}, std::move(what), end, part == 0,
             [this, seek, part, in_vain](Json found) {
               if (found.at("stretch").is_null()) return search_before(seek, part);
               const Json& from = found.at("stretch").at(0);
               const Position to = position_in(found.at("stretch").at(1)).value_or(seek->now);
               search_from(seek, {{"goal", from}}, to, false,
                           [this, seek, part, in_vain](const Position& before) {
                             search_part(seek, part, before, in_vain + 1);
                           });
             });
}

/// `not_found` gets the position at which this part begins.
void Session::search_from(const std::shared_ptr<Seek>& seek, Json begin, const Position& end,
                          bool is_first, std::function<void(const Position& from)> not_found) {
  ask_search(seek, std::move(begin), seek->what, end, is_first,
             [seek, not_found = std::move(not_found)](Json found) {
               if (found.at("hit").is_null())
                 return not_found(position_in(found.at("from")).value_or(Position()));
               found.erase("from");
               seek->found(*seek, std::move(found));
             });
}

/// What Search::perform() answers in a worker that begins there.
void Session::ask_search(const std::shared_ptr<Seek>& seek, Json begin, Json what,
                         const Position& end, bool is_first, std::function<void(Json found)> take) {
  ask_past(seek, std::move(begin), search_method,
           {{"what", std::move(what)},
            {"end", to_json(end)},
            {"now", to_json(seek->now)},
            {"is_first", is_first}},
           {}, [this, seek, take = std::move(take)](Answer answer) {
             if (answer.ok() && answer.result.at("interrupted") == Json(true))
               answer = refuse("the search was interrupted; the simulation stays where it was");
             if (!answer.ok()) return end_seek(*seek, std::move(answer));
             answer.result.erase("interrupted");
             take(std::move(answer.result));
           });
}

void Session::go_to(Request& request) {
  Json goal = goal_in(request.parameters, positions);
  if (goal.is_null())
    return answer(request,
                  refuse(fmt::format("simulation.goto: give {}, one of them", position_words),
                         Code::wrong_parameter));
  seek(request, {{"goal", goal}}, [this, goal](const Json&, const std::shared_ptr<Seek>& seek) {
    replace(seek, goal, Json::object());
  });
}

void Session::select_history(Request& request) {
  seek(request, {{"select", request.parameters.at("number")}},
       [this](Json left, const std::shared_ptr<Seek>& seek) {
         replace(seek, std::move(left.at("goal")), Json::object());
       });
}

void Session::go_back(Request& request) {
  const Json& given = request.parameters;
  std::size_t goals = 0;
  for (const auto& [name, value] : given.items()) goals += name == "simulation" ? 0 : 1;
  const Json distance = goal_in(given, distances);
  const auto wrong = [&](const char* sentence) {
    answer(request, refuse(sentence, Code::wrong_parameter));
  };
  if (goals == 1 && !distance.is_null())
    return seek(request, {{"back", distance}},
                [this](Json left, const std::shared_ptr<Seek>& seek) {
                  replace(seek, left.at("goal"), {{"reason", left.at("reason")}});
                });
  Json what;
  if (const auto address = given.find("address"); address != given.end()) {
    what = {{"address", *address}};
  } else if (const auto asked = given.find("expression"); asked != given.end()) {
    const auto text = asked->find("text");
    const uint64_t every = step_in(*asked);
    if (text == asked->end() || !text->is_string() || every == 0)
      return wrong(R"(history.back: write expression as {"text": "turns > 3", "every_s": 0.001})");
    what = {{"expression", *text}, {"every_ps", every}};
  }
  if (goals != 1 || what.is_null())
    return wrong(
        "history.back: give seconds (0 to 1e6), cycles, instructions, samples, address or "
        "expression, one of them");
  find(request, what, [this](const std::shared_ptr<Seek>& seek, Json found) {
    const char* const reason = seek->what.contains("address") ? "address" : "expression";
    if (!found.at("hit").is_null()) return replace(seek, found.at("hit"), {{"reason", reason}});
    replace(seek, to_json(seek->now), {{"reason", "never"}});
  });
}

/// Resolves `what` in the present and searches for it.
void Session::find(Request& request, Json what,
                   std::function<void(const std::shared_ptr<Seek>&, Json)> found) {
  seek(request, {{"what", std::move(what)}},
       [this, found = std::move(found)](Json left, const std::shared_ptr<Seek>& seek) {
         seek->what = std::move(left.at("what"));
         const std::weak_ptr<Seek> weak = seek;
         seek->found = [weak, found](const Seek&, Json hit) { found(weak.lock(), std::move(hit)); };
         search(seek, seek->last());
       });
}

namespace {

Answer not_found() {
  Answer answer;
  answer.result["found"] = false;
  return answer;
}

}  // namespace

void Session::find_write(Request& request) {
  const Json& given = request.parameters;
  Json what = Json::object();
  for (const char* name : {"address", "variable", "register"})
    if (given.contains(name)) what[name] = given.at(name);
  const bool has_size = given.contains("size");
  if (what.size() != 1 || (has_size && !what.contains("address")))
    return answer(
        request,
        refuse("history.last_write: give an address (and a size), a variable or a register",
               Code::wrong_parameter));
  if (what.contains("address")) what["size"] = has_size ? given.at("size") : Json(4);
  find(request, {{"last_write", what}}, [this](const std::shared_ptr<Seek>& seek, Json found) {
    if (found.at("hit").is_null()) return end_seek(*seek, not_found());
    if (found.at("by") != Json("instruction")) {
      Answer told;
      told.result = {{"found", true},
                     {"by", found.at("by")},
                     {"position", found.at("hit")},
                     {"old", found.at("old")},
                     {"new", found.at("new")}};
      return end_seek(*seek, std::move(told));
    }
    const auto count = found.at("hit").at("instructions").get<uint64_t>() - 1;
    ask_past(seek, {{"goal", to_json(Target{Unit::instructions, count})}}, describe_method,
             {{"what", seek->what}}, {}, [this, seek](Answer answer) {
               if (answer.ok()) {
                 Json all = {{"found", true}};
                 all.update(answer.result);
                 answer.result = std::move(all);
               }
               end_seek(*seek, std::move(answer));
             });
  });
}

void Session::find_change(Request& request) {
  const Json& given = request.parameters;
  const uint64_t every = step_in(given);
  if (given.contains("name") == given.contains("signal") || every == 0)
    return answer(request,
                  refuse("history.last_change: give a name or a signal; every_s has to lie "
                         "between 1e-9 and 1e6",
                         Code::wrong_parameter));
  const char* const kind = given.contains("name") ? "name" : "signal";
  find(request, {{kind, given.at(kind)}, {"every_ps", every}},
       [this](const std::shared_ptr<Seek>& seek, Json found) {
         if (found.at("hit").is_null()) return end_seek(*seek, not_found());
         refine(seek, std::move(found));
       });
}

/// On a finer grid between the last instant with the old value and the first one with the new.
void Session::refine(const std::shared_ptr<Seek>& seek, Json found) {
  const uint64_t every = seek->what.at("every_ps").get<uint64_t>();
  if (seek->what.contains("signal") || every <= finest_ps) {
    Answer told;
    told.result = {{"found", true}, {"position", found.at("hit")}};
    if (found.contains("since")) told.result["since"] = found.at("since");
    told.result["old"] = found.at("old");
    told.result["new"] = found.at("new");
    if (seek->what.contains("signal")) return end_seek(*seek, std::move(told));
    const uint64_t cycles = found.at("since").at("cycles").get<uint64_t>();
    const Json before = to_json(Target{Unit::cycles, cycles - std::min(cycles, cycles_of_a_write)});
    return ask_past(
        seek, {{"goal", before}}, cause_method,
        {{"name", seek->what.at("name")}, {"since", found.at("since")}, {"end", found.at("hit")}},
        {}, [this, seek, told](Answer cause) {
          if (cause.ok()) {
            Json all = told.result;
            all.update(cause.result);
            cause.result = std::move(all);
          }
          end_seek(*seek, std::move(cause));
        });
  }
  seek->what["every_ps"] = std::max(every / finer, finest_ps);
  ask_past(seek, {{"goal", found.at("since")}}, search_method,
           {{"what", seek->what},
            {"end", found.at("hit")},
            {"now", found.at("hit")},
            {"is_first", true}},
           {}, [this, seek, found](Answer answer) {
             if (!answer.ok()) return end_seek(*seek, std::move(answer));
             refine(seek, answer.result.at("hit").is_null() ? found : answer.result);
           });
}

void Session::reverse(Request& request) {
  const Json& kind = request.parameters.at("kind");
  if (kind == Json("step")) {
    const Json one = to_json(Target{Unit::instructions, 1});
    return seek(request, {{"back", one}}, [this](Json left, const std::shared_ptr<Seek>& seek) {
      const bool is_begin = left.at("reason") == Json("beginning");
      replace(seek, left.at("goal"), {{"reason", is_begin ? "beginning" : "step"}});
    });
  }
  if (kind != Json("run"))
    return answer(request, refuse("debugger.reverse: kind is step or run", Code::wrong_parameter));
  const Json what = {{"points", request.parameters.value("points", Json::array())}};
  find(request, what, [this](const std::shared_ptr<Seek>& seek, Json found) {
    if (found.at("hit").is_null())
      return replace(seek, to_json(seek->snapshots.front()), {{"reason", "beginning"}});
    replace(seek, found.at("hit"), found.at("cause"));
  });
}

/// "one" and perhaps "other" of a request as goals; null, and it is answered: they are none.
Json Session::goals_of(Request& request) {
  Json goals = Json::array();
  for (const char* name : {"one", "other"})
    if (const auto given = request.parameters.find(name); given != request.parameters.end())
      goals.push_back(goal_in(*given, positions));
  if (std::none_of(goals.begin(), goals.end(), [](const Json& goal) { return goal.is_null(); }))
    return goals;
  answer(request,
         refuse(fmt::format("{}: a position is {}, one of them", request.method, position_words),
                Code::wrong_parameter));
  return nullptr;
}

/// Asks a worker that goes from "one" to "other" of a request (now, without it).
void Session::ask_between(Request& request, const char* method, Json parameters) {
  const Json goals = goals_of(request);
  if (goals.is_null()) return;
  seek(request, {{"goals", goals}},
       [this, goals, method, parameters = std::move(parameters)](
           const Json&, const std::shared_ptr<Seek>& seek) mutable {
         parameters["end"] = goals.size() == 1 ? to_json(seek->now) : goals.at(1);
         ask_past(seek, {{"goal", goals.at(0)}}, method, std::move(parameters), {},
                  [this, seek](Answer answer) { end_seek(*seek, std::move(answer)); });
       });
}

void Session::tell_past(Request& request) {
  ask_between(request, events_method,
              {{"kinds", request.parameters.value("kinds", Json::array())}});
}

void Session::trace_past(Request& request) {
  ask_between(request, trace_method, {{"files", request.parameters.at("files")}});
}

void Session::explain(Request& request) {
  const auto given = request.parameters.find("sample");
  if (given != request.parameters.end() && *given == Json(0U))
    return answer(request, refuse("history.why: sample counts from 1", Code::wrong_parameter));
  Json goals = Json::array();
  if (given != request.parameters.end())
    goals.push_back(to_json(Target{Unit::samples, given->get<uint64_t>() - 1}));
  seek(request, {{"goals", goals}},
       [this, goals, signal = request.parameters.at("signal")](const Json&,
                                                               const std::shared_ptr<Seek>& seek) {
         const uint64_t now = seek->now.samples;
         const Json before = goals.empty() && now > 0 ? to_json(Target{Unit::samples, now - 1})
                             : goals.empty()          ? Json()
                                                      : goals.at(0);
         if (before.is_null() || target_in(before).value >= now)
           return end_seek(*seek, refuse(fmt::format("history.why: there are {} results", now)));
         ask_past(seek, {{"goal", before}}, why_method, {{"signal", signal}}, {},
                  [this, seek](Answer answer) { end_seek(*seek, std::move(answer)); });
       });
}

void Session::compare(Request& request) {
  const Json goals = goals_of(request);
  if (goals.is_null()) return;
  seek(request, {{"goals", goals}}, [this, goals](const Json&, const std::shared_ptr<Seek>& seek) {
    ask_past(seek, {{"goal", goals.at(0)}}, picture_method, Json::object(), {},
             [this, seek, goals](Answer first) {
               if (!first.ok()) return end_seek(*seek, std::move(first));
               Json from = std::move(first.result.at("position"));
               Json goal = goals.size() == 1 ? to_json(seek->now) : goals.at(1);
               ask_past(seek, {{"goal", std::move(goal)}}, picture_method,
                        {{"one", std::move(first.result.at("picture"))}}, std::move(first.frames),
                        [this, seek, from](Answer both) {
                          if (both.ok()) {
                            Json all = {{"one", from}, {"other", both.result.at("position")}};
                            both.result.erase("position");
                            all.update(both.result);
                            both.result = std::move(all);
                          }
                          end_seek(*seek, std::move(both));
                        });
             });
  });
}

}  // namespace capsoc::service
