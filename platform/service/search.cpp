#include "service/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "armv7m/execution_counts.h"
#include "base/printable.h"
#include "service/signals.h"
#include "service/stop_points.h"

namespace capsoc::service {

Json bytes_at(Board& board, uint32_t address, uint32_t size) {
  Json list = Json::array();
  for (const char byte : board.target().read_memory(address, size))
    list.push_back(static_cast<uint8_t>(byte));
  return list;
}

Search::~Search() {
  if (observes_) board_.soc().cpu.core().remove_observer(*this);
}

void Search::hit(const Json& more) {
  found_ = {{"hit", to_json(board_.position())}};
  found_.update(more);
}

std::optional<Error> Search::run() {
  Advance advance(board_);
  advance.watch(watcher_);
  auto error = advance.go(part_.end);
  is_cut_ = advance.is_interrupted();
  return error;
}

/// An input can write, too.
void Search::watch_input(const std::function<Json()>& value) {
  watcher_.on_input = [this, value](const Input& input, bool is_applied) {
    if (!is_applied) {
      before_input_ = value();
      return;
    }
    Json after = value();
    if (after == before_input_) return;
    hit({{"by", input.method}, {"old", before_input_}, {"new", std::move(after)}});
    changed_by_.reset();
  };
}

std::optional<Error> Search::find_write(uint32_t address, uint32_t size) {
  if (!board_.target().set(debug::StopPoint::write_watchpoint, address, size))
    return Error{fmt::format("{:#010x}: nothing can be watched there", address)};
  watch_input([this, address, size] { return bytes_at(board_, address, size); });
  watcher_.on_run = [this](armv7m::StopReason reason, bool) {
    if (reason == armv7m::StopReason::watchpoint) hit({{"by", "instruction"}});
    return false;
  };
  return run();
}

/// Where debugger.resume would have stopped.
std::optional<Error> Search::find_points(const Json& points) {
  if (auto error = set_points(board_, points)) return error;
  armv7m::Core& core = board_.soc().cpu.core();
  const auto look = [this](armv7m::StopReason reason, bool) {
    const auto cause = board_.target().stop_cause(reason);
    if (cause && cause->kind != debug::StopCause::Kind::lockup && board_.position() < part_.now)
      hit({{"cause", to_json(*cause)}});
    return false;
  };
  if (core.debugging().has_breakpoint(core.reg(15))) look(armv7m::StopReason::breakpoint, false);
  core.debugging().pass_breakpoint();
  watcher_.on_run = look;
  return run();
}

uint32_t Search::value_of_register() const {
  constexpr unsigned program_counter = 15;
  return register_ < program_counter ? board_.soc().cpu.core().reg(register_)
                                     : board_.target().read_register(register_);
}

void Search::issued(const armv7m::Core&, const armv7m::DecodedOp&) {
  if (std::exchange(is_old_, false)) register_before_ = value_of_register();
}

void Search::retired(const armv7m::Core& core, const armv7m::DecodedOp&) {
  const uint32_t value = value_of_register();
  if (std::exchange(register_before_, value) != value) changed_by_ = core.instructions();
}

std::optional<Error> Search::find_register(unsigned index) {
  register_ = index;
  watch_input([this] {
    is_old_ = true;
    return Json(value_of_register());
  });
  board_.soc().cpu.core().add_observer(*this, true, false);
  observes_ = true;
  if (auto error = run()) return error;
  if (changed_by_) found_ = {{"hit", {{"instructions", *changed_by_}}}, {"by", "instruction"}};
  return std::nullopt;
}

/// By the instructions that each stretch executes. An input may change any register.
std::optional<Error> Search::narrow(unsigned index) {
  constexpr uint64_t stretches = 64;
  constexpr unsigned general_registers = 15;
  const Position begin = board_.position();
  const uint64_t all = part_.end.instructions - begin.instructions;
  Json& stretch = found_["stretch"] = nullptr;
  armv7m::ExecutionCounts counts;
  armv7m::Core& core = board_.soc().cpu.core();
  core.count_executions(&counts);
  std::map<uint32_t, armv7m::ExecutionCounts::Totals> totals;
  bool has_input = false;
  watcher_.on_input = [&has_input](const Input&, bool) { has_input = true; };
  std::optional<Error> error;
  for (uint64_t i = 1; i <= stretches && !error && !is_cut_; ++i) {
    const Position from = board_.position();
    Advance advance(board_);
    advance.watch(watcher_);
    error = i == stretches
                ? advance.go(part_.end)
                : advance.go(Target{Unit::instructions, begin.instructions + all * i / stretches});
    is_cut_ = advance.is_interrupted();
    const bool may_change = index >= general_registers || std::exchange(has_input, false) ||
                            (counts.changed_registers(totals) >> index & 1U) != 0;
    if (may_change) stretch = {to_json(from), to_json(board_.position())};
    totals = counts.totals();
  }
  core.count_executions(nullptr);
  return error;
}

/// At the instants of a grid of absolute times in the part.
std::optional<Error> Search::walk_grid(uint64_t every_ps,
                                       const std::function<std::optional<Error>()>& look) {
  const auto first_at = [every_ps](uint64_t time_ps) {
    return (time_ps + every_ps - 1) / every_ps * every_ps;
  };
  const uint64_t last = std::min(first_at(part_.end.time_ps), part_.now.time_ps);
  for (uint64_t next = first_at(board_.position().time_ps); next <= last && !is_cut_;) {
    Advance advance(board_);
    if (auto error = advance.go(Target{Unit::time, next})) return error;
    is_cut_ = advance.is_interrupted();
    const uint64_t now = board_.position().time_ps;
    if (now < next) break;  // the run is over
    if (part_.now < board_.position()) break;
    if (auto error = look()) return error;
    next = (now / every_ps + 1) * every_ps;
  }
  return std::nullopt;
}

std::optional<Error> Search::find_expression(const Json& what) {
  auto expression = Expression::parse(what.at("expression").get<std::string>());
  if (!expression) return Error{expression.error()};
  return walk_grid(what.at("every_ps").get<uint64_t>(), [&]() -> std::optional<Error> {
    const auto value = expression.value().value(
        [this](const std::string& name) { return board_.number_of(name); });
    if (!value) return Error{value.error()};
    if (value.value() != 0 && board_.position() < part_.now) hit();
    return std::nullopt;
  });
}

std::optional<Error> Search::find_change(const Json& what) {
  const auto name = what.at("name").get<std::string>();
  std::optional<double> before;
  Position at;
  const auto look = [&]() -> std::optional<Error> {
    const auto value = board_.number_of(name);
    if (!value) return Error{value.error()};
    if (before && *before != value.value())
      hit({{"since", to_json(at)}, {"old", *before}, {"new", value.value()}});
    before = value.value();
    at = board_.position();
    return std::nullopt;
  };
  if (part_.is_first)
    if (auto error = look()) return error;
  if (auto error = walk_grid(what.at("every_ps").get<uint64_t>(), look)) return error;
  if (is_cut_ || part_.end < part_.now || part_.now <= board_.position()) return std::nullopt;
  if (auto error = run()) return error;
  return look();
}

std::optional<Error> Search::find_signal(const std::string& name) {
  std::optional<Json> before;
  const auto look = [&](const metrics::RecordedSample& sample) {
    if (!sample.result) return;
    Json value = coprocessor_signals(*sample.result).at(name);
    if (before && *before != value) hit({{"old", *before}, {"new", value}});
    before = std::move(value);
  };
  if (!board_.samples().empty()) look(board_.samples().back());
  found_["hit"] = nullptr;
  const kit::Listening listening = board_.simulation().observation().samples.listen(look);
  return run();
}

Answer Search::perform(const Json& what) {
  std::optional<Error> error;
  const Json from = to_json(board_.position());
  if (what.contains("points"))
    error = find_points(what.at("points"));
  else if (what.contains("write"))
    error = find_write(what.at("write").at(0).get<uint32_t>(), what.at("write").at(1));
  else if (what.contains("narrow"))
    error = narrow(what.at("register").get<unsigned>());
  else if (what.contains("register"))
    error = find_register(what.at("register").get<unsigned>());
  else if (what.contains("expression"))
    error = find_expression(what);
  else if (what.contains("signal"))
    error = find_signal(what.at("signal").get<std::string>());
  else
    error = find_change(what);
  if (error) return refuse(error->text);
  Answer answer;
  answer.result = std::move(found_);
  answer.result["interrupted"] = is_cut_;
  answer.result["from"] = from;
  return answer;
}

namespace {

Result<Json> resolve_write(Board& board, const Json& asked) {
  constexpr uint64_t largest = uint64_t{1} << 20;
  if (const auto name = asked.find("register"); name != asked.end()) {
    const auto index = processor_register(board.target(), name->get<std::string>());
    if (!index) return Error{index.error()};
    if (*name == Json("pc"))
      return Error{"pc is changed by every instruction; ask for another one"};
    return Json{{"register", index.value()}};
  }
  uint64_t begin = 0, size = 0;
  if (const auto name = asked.find("variable"); name != asked.end()) {
    const auto variable = board.variables().find(name->get<std::string>(), board.pointers());
    if (!variable) return Error{variable.error()};
    const source::Variable& found = variable.value();
    begin = found.address;
    size = found.size();
  } else {
    const auto address = board.address(asked.at("address"));
    if (!address) return Error{address.error()};
    begin = address.value();
    size = asked.at("size").get<uint64_t>();
  }
  if (size == 0 || size > largest || begin + size > uint64_t{1} << 32U)
    return Error{"history.last_write: a range has 1 byte to 1 MiB"};
  if (board.target().read_memory(static_cast<uint32_t>(begin), static_cast<uint32_t>(size)).size() <
      size)
    return Error{fmt::format("nothing can be read or written at {:#010x}", begin)};
  return Json{{"write", {begin, size}}};
}

}  // namespace

Result<Json> resolve(Board& board, const Json& asked) {
  Json what = asked;
  if (const auto write = asked.find("last_write"); write != asked.end())
    return resolve_write(board, *write);
  if (asked.contains("address")) {
    const auto address = board.address(asked.at("address"));
    if (!address) return Error{address.error()};
    what["points"] = {
        {{"kind", name_of(debug::StopPoint::software_breakpoint)}, {"address", address.value()}}};
  } else if (asked.contains("expression")) {
    const auto expression = Expression::parse(asked.at("expression").get<std::string>());
    if (!expression) return Error{expression.error()};
    const auto value =
        expression.value().value([&](const std::string& name) { return board.number_of(name); });
    if (!value) return Error{value.error()};
  } else if (asked.contains("name")) {
    const auto place = board.registers().find(asked.at("name").get<std::string>());
    if (!place) return Error{place.error()};
  } else if (asked.contains("signal")) {
    const auto name = asked.at("signal").get<std::string>();
    if (!coprocessor_signals({}).contains(name))
      return Error{fmt::format("there is no signal '{}'; coprocessor.read has them all",
                               printable(name, 80))};
  }
  return what;
}

}  // namespace capsoc::service
