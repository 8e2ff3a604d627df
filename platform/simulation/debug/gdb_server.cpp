#include "debug/gdb_server.h"

#include <utility>

namespace capsoc::debug {
namespace {

constexpr std::chrono::milliseconds patience{50};  // how often give_up is asked

}  // namespace

GdbServer::GdbServer(soc::Soc& soc, std::unique_ptr<Connections> connections, bool halted,
                     std::function<bool()> give_up)
    : soc_(soc),
      target_(soc),
      clients_(target_, *this, std::move(connections), halted),
      give_up_(std::move(give_up)) {
  soc_.cpu.set_debugger(this);
  soc_.cpu.core().debugging().set_halted(halted);
}

GdbServer::~GdbServer() {
  soc_.cpu.set_debugger(nullptr);
}

bool GdbServer::before_run() {
  if (clients_.any()) clients_.serve();
  while (clients_.is_halted() && !ended()) {
    if (give_up_()) gave_up_ = true;
    clients_.wait(patience);
    clients_.serve();
  }
  return clients_.how().kind != Resume::Kind::run;
}

bool GdbServer::step_is_over() const {
  const Resume& how = clients_.how();
  if (how.kind != Resume::Kind::range) return true;
  const uint32_t pc = soc_.cpu.core().reg(15);
  return pc < how.range_start || pc >= how.range_end;
}

bool GdbServer::after_run(armv7m::StopReason reason, bool advanced) {
  using armv7m::StopReason;
  if (const auto cause = target_.stop_cause(reason)) {
    if (cause->kind == StopCause::Kind::lockup && !clients_.is_debugged()) return false;
    clients_.halt(*cause);
    return true;
  }
  if (reason == StopReason::semihosting_exit || reason == StopReason::reset_request) return false;
  if (clients_.how().kind == Resume::Kind::run || !advanced || !step_is_over()) return false;
  clients_.halt({StopCause::Kind::step});
  return true;
}

bool GdbServer::asleep_for_good() {
  if (!clients_.is_debugged() && !clients_.any()) return false;
  clients_.wait(patience);
  return true;
}

void GdbServer::resumed() {
  if (clients_.is_halted()) soc_.cpu.core().debugging().pass_breakpoint();
  soc_.cpu.core().debugging().set_halted(false);
}

}  // namespace capsoc::debug
