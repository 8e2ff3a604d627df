#include "debug/gdb_server.h"

#include <algorithm>
#include <utility>

namespace capsoc::debug {
namespace {

constexpr std::chrono::milliseconds patience{50};  // how often give_up is asked

}  // namespace

GdbServer::GdbServer(soc::Soc& soc, std::unique_ptr<Connections> connections, bool halted,
                     std::function<bool()> give_up)
    : soc_(soc),
      target_(soc),
      connections_(std::move(connections)),
      give_up_(std::move(give_up)),
      halted_(halted) {
  soc_.cpu.set_debugger(this);
  soc_.cpu.core().debugging().set_halted(halted);
}

GdbServer::~GdbServer() {
  soc_.cpu.set_debugger(nullptr);
}

bool GdbServer::before_run() {
  if (connections_->any()) serve();
  while (halted_ && !ended_) {
    if (give_up_()) ended_ = true;
    connections_->wait(patience);
    serve();
  }
  return how_.kind != Resume::Kind::run;
}

bool GdbServer::step_is_over() const {
  if (how_.kind != Resume::Kind::range) return true;
  const uint32_t pc = soc_.cpu.core().reg(15);
  return pc < how_.range_start || pc >= how_.range_end;
}

bool GdbServer::after_run(armv7m::StopReason reason, bool advanced) {
  using armv7m::StopReason;
  using Kind = StopCause::Kind;
  switch (reason) {
    case StopReason::breakpoint: {
      const uint32_t pc = soc_.cpu.core().reg(15);
      halt({soc_.cpu.core().debugging().has_breakpoint(pc) ? Kind::breakpoint
                                                           : Kind::bkpt_instruction,
            target_.breakpoint_kind(pc)});
      return true;
    }
    case StopReason::watchpoint: {
      const armv7m::WatchHit& hit = soc_.cpu.core().debugging().watch_hit();
      const StopPoint point = !hit.watchpoint.on_read    ? StopPoint::write_watchpoint
                              : !hit.watchpoint.on_write ? StopPoint::read_watchpoint
                                                         : StopPoint::access_watchpoint;
      halt({Kind::watchpoint, point, hit.address});
      return true;
    }
    case StopReason::lockup:
    case StopReason::stuck:
      if (!debugged()) return false;
      halt({Kind::lockup});
      return true;
    case StopReason::budget:
    case StopReason::attention:
    case StopReason::sleeping:
      if (how_.kind == Resume::Kind::run || !advanced || !step_is_over()) return false;
      halt({Kind::step});
      return true;
    case StopReason::semihosting_exit:
    case StopReason::reset_request:
      break;
  }
  return false;
}

bool GdbServer::asleep_for_good() {
  if (!debugged() && !connections_->any()) return false;
  connections_->wait(patience);
  return true;
}

void GdbServer::serve() {
  LineEvent event;
  while (connections_->next(event)) {
    if (event.kind == LineEvent::Kind::connected) {
      sessions_.emplace_back(event.socket, target_);
      continue;
    }
    if (event.kind == LineEvent::Kind::closed) {
      leave(event.socket.get());
      continue;
    }
    for (Session& session : sessions_)
      if (session.socket == event.socket) {
        receive(session, event.bytes);
        break;  // the list may have changed
      }
  }
}

bool GdbServer::debugged() const {
  return std::any_of(sessions_.begin(), sessions_.end(), [](const Session& s) { return s.debugs; });
}

/// The client's first packet: from here on it is a debugger.
void GdbServer::begin(Session& session) {
  const bool first = !debugged();
  session.debugs = true;
  session.controls = first;
  soc_.cpu.core().debugging().set_halting(true);
  if (first && !halted_) halt({StopCause::Kind::attached});
  session.client.set_cause(halted_ ? cause_ : StopCause{});
}

void GdbServer::receive(Session& session, const std::string& bytes) {
  const std::shared_ptr<Socket> socket = session.socket;
  for (const Arrival& arrival : session.reader.feed(bytes)) {
    if (!session.debugs) {
      // The byte 0x03 is in every TLS greeting: it interrupts only behind a packet.
      if (arrival.kind == Arrival::Kind::interrupt) continue;
      if (arrival.kind == Arrival::Kind::packet) begin(session);
    }
    const Request request = session.client.handle(arrival);
    if (session.client.no_ack()) session.reader.ignore_checksums();
    flush(session);
    act(session, request);
    const bool gone = std::none_of(sessions_.begin(), sessions_.end(),
                                   [&](const Session& s) { return s.socket == socket; });
    if (gone) return;
  }
}

void GdbServer::act(Session& session, const Request& request) {
  if (request.kind != Request::Kind::none) session.controls = true;
  switch (request.kind) {
    case Request::Kind::none:
      break;
    case Request::Kind::resume:
      resume(request.resume);
      break;
    case Request::Kind::halt:
      halt({StopCause::Kind::interrupted});
      break;
    case Request::Kind::detach:
      session.socket->shut_down();
      leave(session.socket.get());
      break;
    case Request::Kind::kill:
      ended_ = true;
      break;
  }
}

void GdbServer::flush(Session& session) {
  const std::string output = session.client.take_output();
  if (!output.empty() && !session.socket->send(output)) session.socket->shut_down();
}

void GdbServer::leave(const Socket* socket) {
  const auto leaving = std::find_if(sessions_.begin(), sessions_.end(), [socket](const Session& s) {
    return s.socket.get() == socket;
  });
  if (leaving == sessions_.end()) return;
  const bool debugged_here = leaving->debugs;
  sessions_.erase(leaving);
  if (!debugged_here) return;
  const bool held =
      std::any_of(sessions_.begin(), sessions_.end(), [](const Session& s) { return s.controls; });
  soc_.cpu.core().debugging().set_halting(debugged());
  if (!held) resume({});
}

void GdbServer::halt(const StopCause& cause) {
  halted_ = true;
  soc_.cpu.core().debugging().set_halted(true);
  cause_ = cause;
  how_ = {};
  for (Session& session : sessions_) {
    session.client.stopped(cause);
    flush(session);
  }
}

void GdbServer::resume(const Resume& how) {
  if (halted_) soc_.cpu.core().debugging().pass_breakpoint();
  halted_ = false;
  soc_.cpu.core().debugging().set_halted(false);
  how_ = how;
}

void GdbServer::finish(int exit_code) {
  for (Session& session : sessions_) {
    session.client.exited(exit_code);
    flush(session);
  }
}

}  // namespace capsoc::debug
