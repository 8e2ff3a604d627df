#include "service/worker.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <functional>
#include <map>
#include <new>
#include <set>
#include <string_view>

#include "host/child_process.h"
#include "host/descriptor_passing.h"
#include "host/end_signals.h"
#include "service/board.h"
#include "service/board_verbs.h"
#include "service/cause.h"
#include "service/events.h"
#include "service/part_traces.h"
#include "service/picture.h"
#include "service/recording.h"
#include "service/search.h"
#include "service/why.h"

namespace capsoc::service {
namespace {

constexpr int interrupt_signal = SIGUSR2;
constexpr int kept_memory = 16 << 20;  // bytes

/// Of this process, if it is a worker; for the signal's handler.
Shared* to_be_interrupted = nullptr;
std::atomic<uint64_t> current_call{0};
std::atomic<run::Simulation*> current_simulation{nullptr};

void interrupt_current(int) {
  run::Simulation* const simulation = current_simulation;
  const uint64_t call = current_call;
  if (simulation != nullptr && call != 0 && to_be_interrupted->interrupted_call == call)
    simulation->interrupt();
}

void catch_interruptions() {
  struct sigaction action {};
  action.sa_handler = interrupt_current;
  action.sa_flags = SA_RESTART;
  sigaction(interrupt_signal, &action, nullptr);
}

Answer too_long() {
  return refuse("the answer has more than 16 MiB of text; ask for a part of it, or read memory");
}

bool is_too_long(const std::string& bytes) {
  return bytes.find('\n') > MessageReader::longest_line;
}

/// An answer as it goes to the session.
std::string bytes_of(uint64_t call, Answer answer) {
  std::string bytes = to_bytes(Json{{"call", call}}, std::move(answer));
  return is_too_long(bytes) ? bytes_of(call, too_long()) : bytes;
}

/// An answer that the session passes on to a client without a look into it.
std::string bytes_for_client(uint64_t call, const Json& id, Answer answer) {
  std::string bytes = to_client(id, std::move(answer));
  if (is_too_long(bytes)) return bytes_for_client(call, id, too_long());
  Message message{{{"call", call}}, {}};
  message.frames.push_back(std::move(bytes));
  return to_bytes(message);
}

/// Standard error goes nowhere: for as long as this lives, or for good.
class Muted {
 public:
  Muted() {
    std::fflush(stderr);
    kept_.reset(fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 0));
    const host::Descriptor nowhere(open("/dev/null", O_WRONLY | O_CLOEXEC));
    if (nowhere.valid()) dup2(nowhere.get(), STDERR_FILENO);
  }
  ~Muted() {
    std::fflush(stderr);
    if (kept_.valid()) dup2(kept_.get(), STDERR_FILENO);
  }
  void stay() { kept_.reset(); }
  Muted(const Muted&) = delete;
  Muted& operator=(const Muted&) = delete;

 private:
  host::Descriptor kept_;
};

bool is_of_history(const std::string& method) {
  static const std::set<std::string> all = {leave_method, search_method,  describe_method,
                                            cause_method, picture_method, events_method,
                                            trace_method, why_method};
  return all.count(method) > 0;
}

class Worker {
 public:
  /// `ends` as in WorkerProcess.
  Worker(host::Descriptor connection, host::Descriptor ends, pid_t session, std::string writes_in)
      : connection_(std::move(connection)),
        ends_(std::move(ends)),
        session_(session),
        writes_in_(std::move(writes_in)) {}

  [[noreturn]] void serve() {
    for (;;) {
      while (auto incoming = reader_.next()) {
        if (!incoming->message) _exit(1);  // the session writes no such thing
        take(*incoming->message);
      }
      receive();
    }
  }

 private:
  void receive() {
    char buffer[65536];
    const ssize_t count = read(connection_.get(), buffer, sizeof buffer);
    if (count > 0) return reader_.feed({buffer, static_cast<std::size_t>(count)});
    if (count < 0 && errno == EINTR && host::noted_signal() == 0) return;
    leave();
  }

  /// The session has gone, or has no use for it, or a signal ended it: outputs are written.
  [[noreturn]] void leave() {
    if (board_ != nullptr && !past_) board_->finish();
    _exit(0);
  }

  void send(const std::string& bytes) {
    if (!host::write_all(connection_.get(), bytes)) leave();
  }

  void take(Message& message) {
    const auto call = message.body.at("call").get<uint64_t>();
    current_call = call;
    if (board_ != nullptr && !board_->is_finished()) board_->simulation().take_interruption();
    Answer answer = perform(message);
    current_call = 0;
    if (std::exchange(is_fresh_, false)) {
      Message first;
      first.body = std::move(message.body.at("params").at("first"));
      first.body["method"] = construct_method;
      first.frames = std::move(message.frames);
      reader_ = MessageReader();
      return take(first);
    }
    const auto id = message.body.find("id");
    send(id == message.body.end() ? bytes_of(call, std::move(answer))
                                  : bytes_for_client(call, *id, std::move(answer)));
  }

  /// An unforeseen exception also becomes an answer.
  Answer perform(Message& message) {
    try {
      return perform_method(message);
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      return refuse(fmt::format("internal error: {}", error.what()));
    }
  }

  Answer perform_method(Message& message) {
    const auto method = message.body.at("method").get<std::string>();
    const Json& parameters = message.body.at("params");
    if (method == construct_method) return construct(parameters, message.frames);
    if (method == park_method) return park(parameters, message.frames);
    if (method == fork_method) return fork_worker(parameters, message.frames);
    if (board_ == nullptr) return refuse("the simulation was not constructed");
    const bool advances = method == "simulation.advance" || method == "debugger.resume";
    if (advances && to_be_interrupted->interrupted_call == current_call)
      return interrupted_before();
    if (method == snapshot_method) return snapshot();
    if (board_->is_finished() && is_of_history(method))
      return refuse("the simulation is finished", Code::over);
    if (method == leave_method) return leave_for(parameters);
    if (method == search_method) return search(parameters);
    if (method == describe_method) return describe_write(*board_, parameters.at("what"));
    if (method == cause_method)
      return describe(*board_, {parameters.at("name").get<std::string>(),
                                position_in(parameters.at("since")).value_or(Position()),
                                position_in(parameters.at("end")).value_or(Position())});
    if (method == picture_method) return picture(parameters, message.frames);
    if (method == events_method) return events(parameters);
    if (method == trace_method) return trace(parameters);
    if (method == why_method)
      return explain_next_result(*board_, parameters.at("signal").get<std::string>());
    if (const BoardVerb* const verb = board_verb(method))
      return perform(*verb, parameters, message.frames);
    return refuse("there is no method " + method, Code::unknown_method);
  }

  Answer perform(const BoardVerb& verb, const Json& parameters, const Frames& frames) {
    const Call call(verb.about, parameters, frames);
    if (std::string complaint = call.complaint(); !complaint.empty())
      return refuse(std::move(complaint), Code::wrong_parameter);
    if (board_->is_finished() && verb.effect != Effect::looks_after_the_end)
      return refuse(verb.about.method + ": the simulation is finished", Code::over);
    if (verb.effect != Effect::input || !board_->history().is_on()) {
      Answer answer = verb.perform(*board_, call);
      board_->remember();
      return answer;
    }
    Input input{board_->position(), verb.about.method, parameters, frames};
    input.parameters.erase("simulation");
    Answer answer = perform_input(*board_, verb, call);
    // A refused write may have written a part.
    const bool wrote = verb.about.method == "memory.write" || verb.about.method == "variable.write";
    if (!answer.ok() && !wrote) return answer;
    const auto ended = board_->history().add(std::move(input));
    board_->forget_told();
    if (ended && answer.ok()) {
      Json& old = answer.result["ended_history"] = to_json(ended->at);
      old["history"] = ended->number;
    }
    return answer;
  }

  Answer interrupted_before() {
    Answer answer;
    answer.result = {
        {"state", board_->state()}, {"reason", "interrupted"}, {"events", Json::array()}};
    return answer;
  }

  Answer construct(const Json& parameters, Frames& frames) {
    if (parameters.contains("history")) {
      auto history = History::unpack(parameters.at("history"), frames);
      if (!history) return refuse(history.error());
      past_.emplace(std::move(history.value()));
    }
    if (past_) return construct_in_the_past(parameters, frames);
    Board::Snapshot from;
    const auto expected = parameters.find("expected");
    const bool repeats = expected != parameters.end();
    Repetition laid;
    std::string log;
    if (repeats) {
      log = std::move(frames.at(0));
      laid = {nullptr, parameters.at("settings"), std::move(frames.at(1)), {}, {}};
      from = Board::Snapshot::of(laid.state);
    } else if (parameters.contains("held")) {
      from = {parameters.at("held"), std::move(frames)};
    }
    auto board = repeats ? service::construct(laid, writes_in_)
                         : Board::construct(parameters.at("settings"), from, writes_in_);
    if (!board) return refuse(board.error());
    take_board(std::move(board.value()));
    board_->begin_history(from);
    if (repeats)
      if (auto error = expect(*expected, log)) return refuse(error->text);
    Answer answer;
    answer.result["state"] = board_->state();
    return answer;
  }

  /// The inputs of a recorded session, whose end is the end of the history.
  std::optional<Error> expect(const Json& expected, const std::string& log) {
    if (!board_->history().is_on())
      return Error{fmt::format("there is no history: {}", board_->no_history())};
    const auto inputs = inputs_in(log);
    if (!inputs) return Error{inputs.error()};
    board_->history().expect(inputs.value(), position_in(expected.at("end")).value_or(Position()));
    return std::nullopt;
  }

  void take_board(std::unique_ptr<Board> board) {
    board_ = std::move(board);
    current_simulation = &board_->simulation();
    board_->ask_for_interruption(
        [] { return current_call != 0 && to_be_interrupted->interrupted_call == current_call; });
  }

  /// Whatever it says is said by the workers that it forks, if at all.
  Answer park(const Json& parameters, const Frames& frames) {
    auto history = History::unpack(parameters.at("history"), frames);
    if (!history) return refuse(history.error());
    past_.emplace(std::move(history.value()));
    muted_ = std::make_unique<Muted>();
    auto board = Board::prepare(parameters.at("settings"), writes_in_);
    if (!board) return refuse(board.error());
    board_ = std::move(board.value());
    return {};
  }

  /// What the new worker begins with is prepared here: the next one may begin there, too.
  std::optional<Error> prepare_for(const Json& first) {
    const History::Snapshot& snapshot = past_->snapshots().at(begin_of(first));
    if (serial_ == snapshot.serial) return std::nullopt;
    from_ = Board::Snapshot::of(snapshot.bytes);
    serial_ = 0;
    if (auto error = board_->set_state(from_)) return error;
    serial_ = snapshot.serial;
    return std::nullopt;
  }

  /// In the spare the answer; in the new worker, which has its own connection, nothing to be sent.
  Answer fork_worker(const Json& parameters, const Frames& frames) {
    host::Descriptor connection = host::receive_descriptor(ends_.get());
    if (!connection.valid()) return refuse("no connection came");
    if (parameters.contains("history")) {
      auto history = History::unpack(parameters.at("history"), frames, std::move(*past_));
      if (!history) return refuse(history.error());
      past_.emplace(std::move(history.value()));
    }
    if (auto error = prepare_for(parameters.at("first").at("params"))) return refuse(error->text);
    const pid_t process = host::fork_beside();
    if (process < 0) return refuse(std::strerror(errno));
    Answer answer;
    answer.result["process"] = process;
    if (process > 0) return answer;
    host::end_with_parent(session_, 1);
    setpgid(0, 0);
    to_be_interrupted += parameters.at("place").get<std::ptrdiff_t>();
    connection_ = std::move(connection);
    ends_.reset();
    is_fresh_ = true;
    return answer;
  }

  /// From a snapshot of a history to a target. What was said on the way before is not said again.
  Answer construct_in_the_past(const Json& parameters, const Frames& frames) {
    const std::unique_ptr<Muted> muted =
        muted_ != nullptr ? std::move(muted_) : std::make_unique<Muted>();
    if (parameters.value("for_good", false)) muted->stay();
    const std::size_t begin = begin_of(parameters);
    if (board_ == nullptr) {
      auto board =
          Board::construct(parameters.at("settings"),
                           Board::Snapshot::of(past_->snapshots().at(begin).bytes), writes_in_);
      if (!board) return refuse(board.error());
      take_board(std::move(board.value()));
    } else {
      if (auto error = board_->begin(from_)) return refuse(error->text);
      from_ = {};
      take_board(std::move(board_));
    }
    board_->continue_history(std::move(*past_), begin);
    past_.reset();
    board_->mute();
    if (const Json activity = recorded_activity(parameters); !activity.is_null())
      board_->activity().begin(activity.get<std::size_t>());
    Advance advance(*board_);
    if (const auto goal = parameters.find("goal"); goal != parameters.end()) {
      if (parameters.contains("told"))
        if (auto error = approach(*goal)) return refuse(error->text);
      if (auto error = go(advance, *goal)) return refuse(error->text);
    }
    if (parameters.contains("told"))
      if (auto error = board_->set_told(parameters.at("told"), frames)) return refuse(error->text);
    Answer answer;
    answer.result = {{"state", board_->state()}, {"interrupted", advance.is_interrupted()}};
    return answer;
  }

  /// Takes snapshots on the way, nearer and nearer to the goal: who steps back steps on, and begins
  /// there.
  std::optional<Error> approach(const Json& goal) {
    const auto position = position_in(goal);
    if (!position && target_in(goal).unit != Unit::instructions) return std::nullopt;
    const uint64_t count = position ? position->instructions : target_in(goal).value;
    for (const uint64_t distance : {1'000'000, 100'000, 10'000, 1'000}) {
      const uint64_t now = board_->position().instructions;
      if (count < now + 2 * distance) continue;
      Advance advance(*board_);
      if (auto error = advance.go(Target{Unit::instructions, count - distance})) return error;
      if (advance.is_interrupted()) return std::nullopt;
      if (auto error = board_->keep()) return error;
    }
    return std::nullopt;
  }

  /// The snapshot that a construction in the past begins with.
  std::size_t begin_of(const Json& parameters) const {
    if (parameters.contains("snapshot")) return parameters.at("snapshot").get<std::size_t>();
    const Json& goal = parameters.at("goal");
    const auto position = position_in(goal);
    const std::size_t before = position ? past_->before(*position) : past_->before(target_in(goal));
    return before_activity(before, recorded_activity(parameters));
  }

  /// A window of Activity that the client looks at, in a construction; null: none.
  static Json recorded_activity(const Json& parameters) {
    const auto told = parameters.find("told");
    return told == parameters.end() ? Json() : told->value("activity", Json());
  }

  /// A snapshot from where the window before `snapshot` is recorded on the way; not so long ago
  /// that the way takes long.
  std::size_t before_activity(std::size_t snapshot, const Json& window) const {
    constexpr uint64_t most_instructions = 20'000'000;
    if (window.is_null()) return snapshot;
    const uint64_t length = ActivityRecord::windows.at(window.get<std::size_t>());
    const auto& all = past_->snapshots();
    const Position& from = all.at(snapshot).at;
    while (snapshot > 0 && all[snapshot].at.time_ps + length > from.time_ps &&
           from.instructions - all[snapshot - 1].at.instructions <= most_instructions)
      --snapshot;
    return snapshot;
  }

  static std::optional<Error> go(Advance& advance, const Json& goal) {
    const auto position = position_in(goal);
    return position ? advance.go(*position) : advance.go(target_in(goal));
  }

  /// The history and what the client knows, for a worker that takes the place of this one. With a
  /// goal that is still ahead this one goes there itself.
  Answer leave_for(const Json& parameters) {
    if (!board_->history().is_on())
      return refuse(fmt::format("there is no history: {}", board_->no_history()));
    const auto known = parameters.value("known", std::set<uint64_t>());
    if (const auto number = parameters.find("select"); number != parameters.end())
      return leave_for_history(number->get<uint64_t>(), known);
    Answer answer;
    answer.result["now"] = to_json(board_->position());
    answer.result["may_be_forked"] = board_->may_be_forked();
    if (const auto goal = parameters.find("goal"); goal != parameters.end()) {
      const Target target = target_in(*goal);
      if (coordinate(board_->position(), target.unit) < target.value) return go_ahead(target);
      if (auto refusal = refuse_before_beginning(target)) return *refusal;
    }
    for (const Json& goal : parameters.value("goals", Json::array()))
      if (auto refusal = refuse_before_beginning(target_in(goal))) return *refusal;
    if (const auto back = parameters.find("back"); back != parameters.end())
      plan_way_back(target_in(*back), answer.result);
    if (const auto what = parameters.find("what"); what != parameters.end()) {
      auto resolved = resolve(*board_, *what);
      if (!resolved) return refuse(resolved.error());
      answer.result["what"] = std::move(resolved.value());
    }
    board_->history().reach(board_->position());
    answer.result["told"] = board_->told(answer.frames);
    answer.result["history"] = board_->history().pack(answer.frames, known);
    return answer;
  }

  /// Another history, and as goal its end. What was said in it is not said again.
  Answer leave_for_history(uint64_t number, const std::set<uint64_t>& known) {
    board_->history().reach(board_->position());
    History other = board_->history();
    if (number != other.number() && !other.select(number))
      return refuse(
          fmt::format("there is no history {}; history.list has those that are kept", number));
    Answer answer;
    answer.result = {{"now", to_json(board_->position())},
                     {"goal", to_json(other.end())},
                     {"may_be_forked", board_->may_be_forked()}};
    answer.result["told"] = board_->told(answer.frames);
    answer.result["told"].erase("outputs");
    answer.result["history"] = other.pack(answer.frames, known);
    return answer;
  }

  std::optional<Answer> refuse_before_beginning(const Target& target) {
    const Position& beginning = board_->history().beginning();
    if (target.value >= coordinate(beginning, target.unit)) return std::nullopt;
    return refuse(fmt::format(
        "the history begins at {:.12g} s, {} cycles, {} instructions, {} samples; a greater "
        "history_mb keeps more",
        static_cast<double>(beginning.time_ps) * 1e-12, beginning.cycles, beginning.instructions,
        beginning.samples));
  }

  /// Where so much before now is, at the earliest the beginning.
  void plan_way_back(const Target& distance, Json& result) {
    static constexpr const char* reasons[] = {"time", "cycles", "instructions", "samples"};
    const uint64_t now = coordinate(board_->position(), distance.unit);
    const Position& beginning = board_->history().beginning();
    if (now - std::min(now, distance.value) < coordinate(beginning, distance.unit) ||
        distance.value > now) {
      result["goal"] = to_json(beginning);
      result["reason"] = "beginning";
      return;
    }
    result["goal"] = to_json(Target{distance.unit, now - distance.value});
    result["reason"] = reasons[static_cast<std::size_t>(distance.unit)];
  }

  Answer go_ahead(const Target& target) {
    if (board_->simulation().is_over())
      return refuse("the simulation is over and cannot advance", Code::over);
    Advance advance(*board_);
    if (auto error = advance.go(target)) return refuse(error->text);
    Answer answer;
    answer.result = {{"state", board_->state()}, {"interrupted", advance.is_interrupted()}};
    return answer;
  }

  Answer search(const Json& parameters) {
    const Part part{position_in(parameters.at("end")).value_or(Position()),
                    position_in(parameters.at("now")).value_or(Position()),
                    parameters.at("is_first").get<bool>()};
    return Search(*board_, part).perform(parameters.at("what"));
  }

  /// With another one: how they differ.
  Answer picture(const Json& parameters, const Frames& frames) {
    const Picture taken = Picture::of(*board_);
    Answer answer;
    if (parameters.contains("one"))
      answer.result = difference(*board_, Picture::unpack(parameters.at("one"), frames), taken);
    else
      answer.result["picture"] = taken.pack(answer.frames);
    answer.result["position"] = to_json(taken.position);
    return answer;
  }

  /// The part of the history from here to an end, observed; the answer has both positions.
  Answer observe_to(const Json& end, const std::string& method,
                    const std::function<std::optional<Error>()>& begin_observing) {
    const auto at_end = position_in(end);
    const Position begin = board_->position();
    const bool is_behind =
        at_end ? *at_end < begin : target_in(end).value < coordinate(begin, target_in(end).unit);
    if (is_behind) return refuse(method + ": other lies before one", Code::wrong_parameter);
    if (auto error = begin_observing()) return refuse(error->text, Code::wrong_parameter);
    board_->forget_told();
    Advance advance(*board_);
    if (auto error = go(advance, end)) return refuse(error->text);
    if (advance.is_interrupted()) return refuse("the way there was interrupted");
    Answer answer;
    answer.result = {{"one", to_json(begin)}, {"other", to_json(board_->position())}};
    return answer;
  }

  /// What happens from here to an end.
  Answer events(const Json& parameters) {
    auto kinds = parameters.at("kinds").get<std::vector<std::string>>();
    if (kinds.empty()) kinds = Events::kinds();
    Answer answer = observe_to(parameters.at("end"), "history.timeline",
                               [&] { return board_->subscribe(kinds); });
    board_->events().look_for_verdict();
    if (answer.ok()) answer.result["events"] = board_->events().take();
    return answer;
  }

  /// Traces from here to an end.
  Answer trace(const Json& parameters) {
    PartTraceSettings wanted;
    std::unique_ptr<PartTraces> traces;
    Answer answer =
        observe_to(parameters.at("end"), "history.trace", [&]() -> std::optional<Error> {
          if (auto error = wanted.set(parameters.at("files"))) return error;
          if (!wanted.any())
            return Error{"history.trace: files names no trace, for instance profile"};
          auto begun = PartTraces::begin(*board_, wanted);
          if (!begun) return Error{begun.error()};
          traces = std::move(begun.value());
          return std::nullopt;
        });
    if (!answer.ok()) return answer;
    const run::RunResult traced = traces->end();
    answer.result["lost"] = traced.lost;
    Json& functions = answer.result["functions"] = Json::array();
    for (const trace::FunctionCost& function : traced.profile)
      functions.push_back(run::to_json(function));
    return answer;
  }

  Answer snapshot() {
    auto snapshot = board_->is_finished() ? Result<Board::Snapshot>(Error{"it is finished"})
                                          : board_->snapshot();
    if (!snapshot) return refuse("no snapshot: " + snapshot.error());
    Answer answer;
    answer.result["held"] = std::move(snapshot.value().held);
    answer.frames = std::move(snapshot.value().frames);
    return answer;
  }

  host::Descriptor connection_, ends_;
  pid_t session_;
  std::string writes_in_;  // as in Door
  MessageReader reader_;
  std::unique_ptr<Board> board_;
  // Of a spare and of a worker that begins in the past.
  std::optional<History> past_;
  std::unique_ptr<Muted> muted_;
  Board::Snapshot from_;   // which the board has in it
  uint64_t serial_ = 0;    // of that; 0: none
  bool is_fresh_ = false;  // forked just now
};

[[noreturn]] void work(host::Descriptor connection, host::Descriptor ends, pid_t session,
                       const std::string& writes_in) {
  try {
    catch_interruptions();
    // Snapshots take and release some hundred KiB many times: pages that are given back are
    // expensive to get again.
    mallopt(M_TRIM_THRESHOLD, kept_memory);
    mallopt(M_MMAP_THRESHOLD, kept_memory / 16);
    Worker(std::move(connection), std::move(ends), session, writes_in).serve();
  } catch (const std::bad_alloc&) {
    _exit(out_of_memory);
  } catch (const std::exception& error) {
    const std::string text = fmt::format("capsoc: internal error: {}\n", error.what());
    _exit(write(STDERR_FILENO, text.data(), text.size()) < 0 ? 1 : 70);
  }
}

}  // namespace

SharedPlaces::SharedPlaces() : places_(std::make_shared<Places>()) {
  void* const place = mmap(nullptr, count * sizeof(Shared), PROT_READ | PROT_WRITE,
                           MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (place == MAP_FAILED) return;
  places_->mapped = static_cast<Shared*>(place);
  for (std::size_t i = count; i-- > 0;) places_->free.push_back(i);
}

SharedPlaces::Places::~Places() {
  if (mapped != nullptr) munmap(mapped, count * sizeof(Shared));
}

std::shared_ptr<Shared> SharedPlaces::take() {
  if (places_->free.empty()) return nullptr;
  const std::size_t index = places_->free.back();
  places_->free.pop_back();
  return {new (places_->mapped + index) Shared,
          [places = places_, index](Shared*) { places->free.push_back(index); }};
}

Result<WorkerProcess> WorkerProcess::start(SharedPlaces& places,
                                           const std::function<void()>& close_others,
                                           const std::string& writes_in, bool is_spare) {
  const auto no_process = [](int error) {
    return Error{
        fmt::format("a simulation cannot be started: {}; close another one", std::strerror(error))};
  };
  int pair[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0) return no_process(errno);
  WorkerProcess worker;
  worker.connection.reset(pair[0]);
  host::Descriptor theirs(pair[1]), their_ends;
  if (is_spare) {
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair) != 0) return no_process(errno);
    worker.ends.reset(pair[0]);
    their_ends.reset(pair[1]);
  }
  worker.shared = places.take();
  if (worker.shared == nullptr) return no_process(ENOMEM);
  const pid_t parent = getpid();
  worker.process = fork();
  if (worker.process < 0) return no_process(errno);
  if (worker.process == 0) {
    host::end_with_parent(parent, 1);
    host::leave_terminal();
    close_others();
    to_be_interrupted = worker.shared.get();
    worker.connection.reset();
    worker.ends.reset();
    work(std::move(theirs), std::move(their_ends), parent, writes_in);
  }
  fcntl(worker.connection.get(), F_SETFL, O_NONBLOCK);
  return worker;
}

Result<host::Descriptor> WorkerProcess::connect_next() const {
  int pair[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
    return Error{std::strerror(errno)};
  host::Descriptor ours(pair[0]);
  const host::Descriptor theirs(pair[1]);
  fcntl(ours.get(), F_SETFL, O_NONBLOCK);
  if (!host::send_descriptor(ends.get(), theirs.get())) return Error{std::strerror(errno)};
  return ours;
}

void WorkerProcess::kill() const {
  if (process > 0) ::kill(process, SIGKILL);
}

void WorkerProcess::interrupt(uint64_t call) const {
  shared->interrupted_call = call;
  ::kill(process, interrupt_signal);
}

}  // namespace capsoc::service
