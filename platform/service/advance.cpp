#include "service/advance.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/printable.h"
#include "kit/seconds.h"
#include "serial/line_watch.h"
#include "service/board_verbs.h"
#include "trace/exception_name.h"

namespace capsoc::service {
namespace {

constexpr double longest_s = 1e6;
constexpr unsigned exception_count = 16 + armv7m::Core::interrupt_count;

sc_core::sc_time time_of(double seconds) {
  return {std::round(seconds * 1e12), sc_core::SC_PS};
}

sc_core::sc_time time_of(const Position& position) {
  return sc_core::sc_time::from_value(position.time_ps);
}

bool is_time(double seconds) {
  return seconds >= 0 && seconds <= longest_s;
}

Answer wrong(std::string sentence) {
  return refuse(std::move(sentence), Code::wrong_parameter);
}

/// The number of an exception: given as such, or by its name.
std::optional<unsigned> exception_named(const Json& given) {
  for (unsigned number = 1; number < exception_count; ++number)
    if (given.is_string() ? trace::exception_name(number) == given.get<std::string>()
                          : given == Json(number))
      return number;
  return std::nullopt;
}

}  // namespace

Advance::~Advance() {
  soc::Soc& soc = board_.soc();
  board_.events().watch_exception(-1, nullptr);
  board_.on_clock_change = nullptr;
  if (uart_) board_.uart(*uart_).forget_pattern();
  if (breakpoint_ && !had_breakpoint_) soc.cpu.core().debugging().clear_breakpoint(*breakpoint_);
  if (has_debugger_) soc.cpu.set_debugger(nullptr);
}

/// Called from within the simulation, or before it continues.
void Advance::stop(const char* reason) {
  if (hit_ == nullptr) hit_ = reason;
  board_.simulation().stop_soon();
}

void Advance::attach_debugger() {
  has_debugger_ = true;
  board_.soc().cpu.set_debugger(this);
}

bool Advance::after_run(armv7m::StopReason reason, bool advanced) {
  const armv7m::Core& core = board_.soc().cpu.core();
  const bool stays = watcher_.on_run && watcher_.on_run(reason, advanced);
  if (stays) stop("debugger");
  // In front of a BKPT the processor would not advance any more.
  if (reason == armv7m::StopReason::breakpoint && is_at_bkpt()) {
    board_.stood_at_bkpt();
    // If the history has an input here, a client moved the processor past the BKPT.
    const Input* const input = board_.history().next();
    if (input != nullptr && input->at == board_.position())
      board_.simulation().stop_soon();
    else
      stop("bkpt");
  }
  if (reason == armv7m::StopReason::breakpoint && breakpoint_) stop("address");
  if (meets_ && core.instructions() >= *meets_) {
    meets_.reset();
    board_.simulation().stop_soon();
  }
  if (instruction_ && core.instructions() >= *instruction_) stop("instructions");
  return stays;
}

bool Advance::is_at_bkpt() const {
  armv7m::Core& core = board_.soc().cpu.core();
  return core.debugging().halting() && !core.debugging().has_breakpoint(core.reg(15));
}

/// Another try would take cycles and get nowhere.
bool Advance::stands_at_bkpt() {
  if (!board_.soc().cpu.core().debugging().halting() || !board_.stands_at_bkpt()) return false;
  hit_ = "bkpt";
  return true;
}

std::optional<Answer> Advance::plan() {
  unsigned goals = 0;
  for (const char* goal : {"seconds", "until_s", "cycles", "instructions", "samples", "address",
                           "exception", "uart", "expression"})
    goals += call_->has(goal) ? 1 : 0;
  if (goals > 1) return wrong("simulation.advance: name one goal; limit the others by within_s");
  if (auto answer = plan_times()) return answer;
  if (auto answer = plan_counts()) return answer;
  if (auto answer = plan_places()) return answer;
  if (auto answer = plan_uart()) return answer;
  return plan_expression();
}

/// The processor has one debugger.
std::optional<Answer> Advance::refuse_beside_gdb() const {
  if (board_.settings().gdb.port() < 0) return std::nullopt;
  return refuse(
      "simulation.advance: gdb.port gives the processor to a debugger, which sets its own "
      "breakpoints; advance by time or cycles");
}

std::optional<Answer> Advance::plan_times() {
  const sc_core::sc_time now = sc_core::sc_time_stamp();
  for (const char* name : {"seconds", "until_s", "within_s"}) {
    if (!call_->has(name)) continue;
    const double seconds = call_->number(name);
    if (!is_time(seconds))
      return wrong(
          fmt::format("simulation.advance: {} has to lie between 0 and {} s", name, longest_s));
    limit_ = time_of(seconds);
    if (std::string_view(name) != "until_s") limit_ += now;
    if (std::string_view(name) == "within_s") limit_is_goal_ = false;
  }
  if (call_->has("within_s") && (call_->has("seconds") || call_->has("until_s")))
    return wrong("simulation.advance: within_s limits what is not a time itself");
  if (limit_ < now)
    return wrong(
        fmt::format("simulation.advance: it is {} s already; time goes forward only, go "
                    "back by simulation.goto",
                    kit::to_seconds(now)));
  return std::nullopt;
}

std::optional<Answer> Advance::plan_counts() {
  soc::Soc& soc = board_.soc();
  const armv7m::Core& core = soc.cpu.core();
  if (call_->has("cycles")) plan_cycles(core.cycles() + call_->integer("cycles"));
  if (call_->has("instructions")) {
    if (auto answer = refuse_beside_gdb()) return answer;
    instruction_ = core.instructions() + call_->integer("instructions");
  }
  if (call_->has("samples")) plan_samples(call_->integer("samples"));
  return std::nullopt;
}

void Advance::plan_cycles(uint64_t until) {
  cycle_ = until;
  // What cycle is when is another matter from here on.
  board_.on_clock_change = [this] {
    clock_changed_ = true;
    board_.simulation().stop_soon();
  };
}

void Advance::plan_samples(uint64_t count) {
  samples_left_ = count;
  if (samples_left_ == 0)
    hit_ = "samples";
  else
    listening_.push_back(
        board_.simulation().observation().samples.listen([this](const metrics::RecordedSample&) {
          if (samples_left_ > 0 && --samples_left_ == 0) stop("samples");
        }));
}

std::optional<Answer> Advance::plan_places() {
  armv7m::Debugging& debugging = board_.soc().cpu.core().debugging();
  if (call_->has("address")) {
    if (auto answer = refuse_beside_gdb()) return answer;
    const auto address = board_.address(call_->json("address"));
    if (!address) return refuse(address.error());
    breakpoint_ = address.value() & ~1U;
    had_breakpoint_ = debugging.has_breakpoint(*breakpoint_);
    debugging.set_breakpoint(*breakpoint_);
    // Where it stands is no arrival.
    debugging.pass_breakpoint();
    attach_debugger();
  }
  if (!call_->has("exception")) return std::nullopt;
  const auto number = exception_named(call_->json("exception"));
  if (!number)
    return wrong(
        fmt::format("simulation.advance: there is no exception {}; give its number (1 to "
                    "{}), or a name as HardFault, SysTick, coprocessor interrupt",
                    printable(call_->json("exception").dump(), 80), exception_count - 1));
  board_.events().watch_exception(static_cast<int>(*number), [this] { stop("exception"); });
  return std::nullopt;
}

std::optional<Answer> Advance::plan_uart() {
  if (!call_->has("uart")) return std::nullopt;
  const Json& wanted = call_->json("uart");
  const auto uart = wanted.find("uart"), pattern = wanted.find("pattern");
  if (uart == wanted.end() || !uart->is_number_unsigned() ||
      uart->get<uint64_t>() >= soc::Soc::uart_count || pattern == wanted.end() ||
      !pattern->is_string())
    return wrong(
        R"(simulation.advance: write uart as {"uart": 0, "pattern": "regular expression"})");
  auto compiled = serial::compile_pattern(pattern->get<std::string>());
  if (!compiled)
    return wrong(fmt::format("simulation.advance: {} is no regular expression: {}",
                             printable(pattern->get<std::string>(), 80), compiled.error()));
  pattern_ = std::move(compiled.value());
  uart_ = uart->get<std::size_t>();
  board_.uart(*uart_).expect(pattern_.get(), [this] { stop("uart"); });
  return std::nullopt;
}

std::optional<Answer> Advance::plan_expression() {
  if (!call_->has("expression")) return std::nullopt;
  const Json& wanted = call_->json("expression");
  const auto text = wanted.find("text"), every = wanted.find("every_s");
  const bool has_step = every != wanted.end();
  if (text == wanted.end() || !text->is_string() || (has_step && !every->is_number()))
    return wrong(
        R"(simulation.advance: write expression as {"text": "turns > 3", "every_s": 0.001})");
  const double step = has_step ? every->get<double>() : 1e-3;
  if (!(step >= 1e-9 && step <= longest_s))
    return wrong("simulation.advance: every_s has to lie between 1e-9 and 1e6");
  every_ = time_of(step);
  auto expression = Expression::parse(text->get<std::string>());
  if (!expression) return wrong(expression.error());
  expression_ = std::move(expression.value());
  if (const auto now = value(); !now) return refuse(now.error());
  return std::nullopt;
}

/// On the way inputs that are logged for later take place, and the history takes its snapshots.
std::optional<Error> Advance::advance_to(const sc_core::sc_time& time) {
  const sc_core::sc_time until = std::min(time, limit_);
  clock_changed_ = false;
  while (!is_over_ && !is_cut_) {
    const Input* const input = board_.history().next();
    const bool waits = input != nullptr && time_of(input->at) <= until;
    const auto more = board_.simulation().advance_to(waits ? time_of(input->at) : until);
    if (!more) return Error{more.error()};
    is_over_ = !more.value();
    if (is_over_) board_.events().look_for_verdict();
    // An early return without a request from this advance: a client interrupted, or the history.
    const bool called = board_.simulation().take_interruption();
    is_cut_ = called && board_.is_interrupted();
    if (asks_a_client()) hit_ = "console";
    if (is_over_ || is_cut_ || hit_ != nullptr || clock_changed_) break;
    const sc_core::sc_time now = sc_core::sc_time_stamp();
    if (waits && now >= time_of(input->at)) {
      if (auto error = meet(input->at)) return error;
      if (hit_ != nullptr) break;
      if (auto error = apply_next()) return error;
      continue;
    }
    if (!called || now >= until) break;
    board_.remember();
  }
  return std::nullopt;
}

/// The time of a position is reached; instructions that take no cycle may be missing.
std::optional<Error> Advance::meet(const Position& position) {
  const armv7m::Core& core = board_.soc().cpu.core();
  const bool is_there = board_.position() == position;
  if (!is_there && core.instructions() < position.instructions &&
      sc_core::sc_time_stamp() == time_of(position)) {
    meets_ = position.instructions;
    if (!has_debugger_) attach_debugger();
    const auto more = board_.simulation().advance_to(sc_core::sc_max_time());
    if (!more) return Error{more.error()};
    is_over_ = !more.value();
    meets_.reset();
  }
  if (board_.position() == position || is_over_) return std::nullopt;
  return Error{
      fmt::format("the history does not repeat: at {} ps {} instructions were executed, now, at {} "
                  "ps, {}; this is a defect of capsoc, please report it",
                  position.time_ps, position.instructions, sc_core::sc_time_stamp().value(),
                  core.instructions())};
}

/// A read of the console waits for input, and the history has none here.
bool Advance::asks_a_client() const {
  if (hit_ != nullptr || !board_.soc().cpu.core().waits_for_answer()) return false;
  const Input* const input = board_.history().next();
  return input == nullptr || !(input->at == board_.position());
}

std::optional<Error> Advance::apply_next() {
  const Input input = *board_.history().next();
  board_.history().pass_next();
  if (watcher_.on_input) watcher_.on_input(input, false);
  auto error = apply_input(board_, input);
  if (watcher_.on_input) watcher_.on_input(input, true);
  return error;
}

/// A position is that after the inputs of its instant.
std::optional<Error> Advance::apply_due() {
  while (const Input* const input = board_.history().next()) {
    if (!(input->at == board_.position())) break;
    if (auto error = apply_next()) return error;
  }
  return std::nullopt;
}

void Advance::watch(Watcher watcher) {
  watcher_ = std::move(watcher);
  if (watcher_.on_run) attach_debugger();
}

std::optional<Error> Advance::go(const Target& target) {
  if (auto error = apply_due()) return error;
  limit_is_goal_ = true;
  switch (target.unit) {
    case Unit::time:
      limit_ = sc_core::sc_time::from_value(target.value);
      break;
    case Unit::cycles:
      plan_cycles(target.value);
      break;
    case Unit::instructions:
      instruction_ = target.value;
      break;
    case Unit::samples:
      plan_samples(target.value - std::min(target.value, board_.sample_count()));
      break;
  }
  if (auto error = run()) return error;
  board_.history().reach(board_.position());
  return apply_due();
}

std::optional<Error> Advance::go(const Position& position) {
  if (auto error = apply_due()) return error;
  limit_ = time_of(position);
  if (auto error = run()) return error;
  if (!is_over_ && !is_cut_)
    if (auto error = meet(position)) return error;
  board_.history().reach(board_.position());
  return apply_due();
}

std::optional<Error> Advance::resume(bool steps, const std::optional<Position>& end) {
  steps_ = steps;
  waits_asleep_ = !end;  // in the past it slept on
  if (stands_at_bkpt()) return std::nullopt;
  if (end) limit_ = time_of(*end);
  if (auto error = advance_to(limit_)) return error;
  if (end && hit_ == nullptr && !is_over_ && !is_cut_)
    if (auto error = meet(*end)) return error;
  board_.history().reach(board_.position());
  return apply_due();
}

std::optional<Error> Advance::kill() {
  kills_ = true;
  attach_debugger();
  return advance_to(limit_);
}

/// Nothing inside the simulation can wake the processor: time stops until a client acts.
bool Advance::asleep_for_good() {
  if (!waits_asleep_) return false;
  stop("asleep");
  return true;
}

std::optional<Error> Advance::run_cycles() {
  const armv7m::Core& core = board_.soc().cpu.core();
  while (!has_ended() && core.cycles() < *cycle_ && (sc_core::sc_time_stamp() < limit_))
    if (auto error = advance_to(board_.soc().clock.time_of(*cycle_))) return error;
  if (!is_over_ && core.cycles() >= *cycle_) hit_ = "cycles";
  return std::nullopt;
}

/// Instructions that are left.
uint64_t Advance::left() const {
  return *instruction_ - std::min(*instruction_, board_.soc().cpu.core().instructions());
}

/// An instruction takes half a cycle at least (an IT that is folded takes none), so half as many
/// cycles as instructions are left pass none of them.
uint64_t Advance::longest_run() const {
  return instruction_ ? std::max<uint64_t>(left() / 2, 1) : ~uint64_t{0};
}

/// In pieces, without a debugger, as long as the processor is busy; then it is asked before each
/// run, and a sleep is no end of a piece.
std::optional<Error> Advance::run_instructions() {
  constexpr uint64_t idle = 16;  // cycles an instruction
  const armv7m::Core& core = board_.soc().cpu.core();
  while (!has_ended() && left() > stepped && sc_core::sc_time_stamp() < limit_) {
    const uint64_t before = left(), piece = before / 2;
    if (auto error = advance_to(board_.soc().clock.time_of(core.cycles() + piece))) return error;
    if (before - left() < piece / idle) break;
  }
  if (left() > 0 && !has_ended() && sc_core::sc_time_stamp() < limit_) {
    attach_debugger();
    return advance_to(limit_);
  }
  if (left() == 0) hit_ = "instructions";
  return std::nullopt;
}

Result<double> Advance::value() {
  return expression_->value([this](const std::string& name) { return board_.number_of(name); });
}

bool Advance::holds(const Result<double>& value, std::optional<Error>& error) {
  if (!value) error = Error{value.error()};
  return value && value.value() != 0;
}

std::optional<Error> Advance::run_expression() {
  std::optional<Error> error;
  while (!has_ended() && !error) {
    if (holds(value(), error)) {
      hit_ = "expression";
      break;
    }
    if (error || sc_core::sc_time_stamp() >= limit_) break;
    // A grid of absolute times: where the advance began does not matter.
    const uint64_t steps = sc_core::sc_time_stamp().value() / every_.value() + 1;
    error = advance_to(sc_core::sc_time::from_value(steps * every_.value()));
  }
  return error;
}

std::optional<Error> Advance::run() {
  if (hit_ != nullptr) return std::nullopt;
  if (stands_at_bkpt()) return std::nullopt;
  if (board_.soc().cpu.core().debugging().halting()) attach_debugger();
  if (cycle_) return run_cycles();
  if (instruction_) return run_instructions();
  if (expression_) return run_expression();
  return advance_to(limit_);
}

Answer Advance::answer() {
  Answer answer;
  const char* const at_limit = limit_is_goal_ ? "time" : "limit";
  const char* const reason = is_over_          ? "over"
                             : hit_ != nullptr ? hit_
                             : is_cut_         ? "interrupted"
                                               : at_limit;
  answer.result = {{"state", board_.state()}, {"reason", reason}};
  if (uart_ && board_.uart(*uart_).match()) {
    const UartTap::Match& match = *board_.uart(*uart_).match();
    Json groups = Json::array();
    for (const auto& group : match.groups) groups.push_back(group ? Json(*group) : Json(nullptr));
    answer.result["match"] = {{"text", match.text}, {"groups", std::move(groups)}};
  }
  answer.result["events"] = board_.events().take();
  return answer;
}

Answer Advance::perform() {
  if (board_.is_finished() || board_.simulation().is_over())
    return refuse(
        "the simulation is over and cannot advance; ask for simulation.finish, or restore "
        "a snapshot",
        Code::over);
  if (auto refusal = plan()) return *refusal;
  if (auto error = run()) return refuse(error->text);
  board_.history().reach(board_.position());
  if (auto error = apply_due()) return refuse(error->text);
  return answer();
}

}  // namespace capsoc::service
