#include "debug/clients.h"

#include <algorithm>
#include <thread>
#include <utility>

namespace capsoc::debug {

Clients::Clients(Target& target, Processor& processor, std::unique_ptr<Connections> connections,
                 bool halted)
    : target_(target),
      processor_(processor),
      connections_(std::move(connections)),
      halted_(halted) {}

void Clients::serve() {
  LineEvent event;
  while (connections_ != nullptr && connections_->next(event)) {
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

void Clients::wait(std::chrono::milliseconds longest) {
  if (connections_ != nullptr)
    connections_->wait(longest);
  else
    std::this_thread::sleep_for(longest);
}

bool Clients::is_debugged() const {
  return std::any_of(sessions_.begin(), sessions_.end(), [](const Session& s) { return s.debugs; });
}

/// The client's first packet: from here on it is a debugger.
void Clients::begin(Session& session) {
  const bool first = !is_debugged();
  session.debugs = true;
  session.controls = first;
  processor_.debugged(true);
  if (first && !halted_) halt({StopCause::Kind::attached});
  session.client.set_cause(halted_ ? cause_ : StopCause{});
}

void Clients::receive(Session& session, const std::string& bytes) {
  const std::shared_ptr<Socket> socket = session.socket;
  for (const Arrival& arrival : session.reader.feed(bytes)) {
    if (!session.debugs) {
      // The byte 0x03 is in every TLS greeting: it interrupts only after a packet.
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

void Clients::act(Session& session, const Request& request) {
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
      killed_ = true;
      break;
  }
}

void Clients::flush(Session& session) {
  const std::string output = session.client.take_output();
  if (!output.empty() && !session.socket->send(output)) session.socket->shut_down();
}

void Clients::leave(const Socket* socket) {
  const auto leaving = std::find_if(sessions_.begin(), sessions_.end(), [socket](const Session& s) {
    return s.socket.get() == socket;
  });
  if (leaving == sessions_.end()) return;
  const bool debugged_here = leaving->debugs;
  sessions_.erase(leaving);
  if (!debugged_here) return;
  const bool held =
      std::any_of(sessions_.begin(), sessions_.end(), [](const Session& s) { return s.controls; });
  processor_.debugged(is_debugged());
  if (!held) resume({});
}

void Clients::halt(const StopCause& cause) {
  halted_ = true;
  processor_.halted();
  cause_ = cause;
  how_ = {};
  for (Session& session : sessions_) {
    session.client.stopped(cause);
    flush(session);
  }
}

void Clients::resume(const Resume& how) {
  processor_.resumed();
  halted_ = false;
  how_ = how;
}

void Clients::print(const std::string& text) {
  if (text.empty()) return;
  for (Session& session : sessions_) {
    if (!session.client.waiting()) continue;
    session.client.print(text);
    flush(session);
  }
}

void Clients::finish(int exit_code) {
  for (Session& session : sessions_) {
    session.client.exited(exit_code);
    flush(session);
  }
}

}  // namespace capsoc::debug
