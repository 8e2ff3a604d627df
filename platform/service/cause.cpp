#include "service/cause.h"

#include <fmt/format.h>

#include <functional>
#include <utility>

#include "armv7m/observer.h"
#include "service/advance.h"
#include "service/search.h"
#include "trace/bus_targets.h"

namespace capsoc::service {
namespace {

/// The address of the last instruction that began.
class LastIssued final : public armv7m::Observer {
 public:
  LastIssued(armv7m::Core& core, std::function<void()> before)
      : core_(core), before_(std::move(before)) {
    core_.add_observer(*this, true, false);
  }
  ~LastIssued() override { core_.remove_observer(*this); }
  LastIssued(const LastIssued&) = delete;
  LastIssued& operator=(const LastIssued&) = delete;
  uint32_t address() const { return address_; }

 private:
  void issued(const armv7m::Core&, const armv7m::DecodedOp& op) override {
    address_ = op.address;
    if (before_) before_();
  }
  void retired(const armv7m::Core&, const armv7m::DecodedOp&) override {}
  void entered(const armv7m::Core&, unsigned, armv7m::Entry, uint64_t) override {}
  void returned(const armv7m::Core&, unsigned) override {}
  void accessed(const armv7m::Core&, const armv7m::DirectAccess&) override {}
  void started(const armv7m::Core&) override {}

  armv7m::Core& core_;
  std::function<void()> before_;
  uint32_t address_ = 0;
};

/// Stops at accesses to a device. Its registers may change by one to another of them, and by a
/// read.
void watch_device(Board& board, const std::string& name) {
  for (const soc::BoardPeripheral& each : board.registers().all())
    if (name.compare(0, each.name.size() + 1, each.name + ".") == 0)
      for (const auto& block : each.blocks)
        for (const auto kind :
             {debug::StopPoint::write_watchpoint, debug::StopPoint::read_watchpoint})
          board.target().set(kind, block.base, block.size);
}

}  // namespace

Answer describe_write(Board& board, const Json& what) {
  armv7m::Core& core = board.soc().cpu.core();
  const auto value = [&]() -> Json {
    if (what.contains("register"))
      return board.target().read_register(what.at("register").get<unsigned>());
    return bytes_at(board, what.at("write").at(0).get<uint32_t>(), what.at("write").at(1));
  };
  const Position position = board.position();
  Json before = value();
  uint32_t pc = 0;
  {
    const LastIssued last(core, [&] { before = value(); });
    Advance advance(board);
    if (auto error = advance.go(Target{Unit::instructions, position.instructions + 1}))
      return refuse(error->text);
    pc = last.address();
  }
  Answer answer;
  answer.result = {{"by", "instruction"},
                   {"pc", pc},
                   {"place", board.simulation().view().place(pc)},
                   {"position", to_json(position)},
                   {"old", std::move(before)},
                   {"new", value()}};
  return answer;
}

namespace {

/// A request that writes to a register of the device, or anywhere.
bool can_write(const Input& input, const std::string& name) {
  if (input.method != "register.write") return input.method == "memory.write";
  const auto written = input.parameters.at("name").get<std::string>();
  return name.compare(0, name.find('.') + 1, written, 0, written.find('.') + 1) == 0;
}

}  // namespace

Answer describe(Board& board, const Change& change) {
  watch_device(board, change.name);
  const LastIssued last(board.soc().cpu.core(), nullptr);
  Answer answer;
  Json& result = answer.result;
  result["by"] = "device";
  Advance::Watcher watcher;
  watcher.on_run = [&](armv7m::StopReason reason, bool) {
    const auto cause = board.target().stop_cause(reason);
    if (!cause || cause->kind != debug::StopCause::Kind::watchpoint ||
        board.position() <= change.since)
      return false;
    const std::string accessed =
        trace::BusTargets(board.registers().all()).register_name(cause->address);
    const bool writes = cause->point == debug::StopPoint::write_watchpoint;
    result = {{"by", "instruction"},
              {"pc", last.address()},
              {"place", board.simulation().view().place(last.address())},
              {"access", writes ? "write" : "read"},
              {"accessed", accessed.empty() ? fmt::format("{:#010x}", cause->address) : accessed}};
    return false;
  };
  Result<double> before = board.number_of(change.name);
  watcher.on_input = [&](const Input& input, bool is_applied) {
    Result<double> value = board.number_of(change.name);
    const bool changed = before && value && before.value() != value.value();
    if (is_applied && (changed || can_write(input, change.name))) result = {{"by", input.method}};
    before = std::move(value);
  };
  Advance advance(board);
  advance.watch(watcher);
  if (auto error = advance.go(change.end)) return refuse(error->text);
  if (result.at("by") == Json("device") && board.position().samples > change.since.samples)
    result["sample"] = board.position().samples;
  return answer;
}

}  // namespace capsoc::service
