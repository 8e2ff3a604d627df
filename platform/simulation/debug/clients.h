// The debuggers that are connected: whose packets come, who has the processor, who is told.
#pragma once

#include <chrono>
#include <list>
#include <memory>
#include <string>
#include <utility>

#include "debug/client.h"
#include "debug/connections.h"

namespace capsoc::debug {

/// Any number of GDBs on one processor, wherever that runs. Its first packet makes a client a
/// debugger; before it, and if none ever comes (a probe of the port), a client changes nothing. The
/// first debugger halts the processor; one that comes later observes without stopping it. The
/// client that resumes or interrupts has it; when the last of these is gone, the run continues by
/// itself.
class Clients {
 public:
  /// What the processor is told.
  class Processor {
   public:
    virtual ~Processor() = default;
    /// There is a debugger, or none any more.
    virtual void debugged(bool on) = 0;
    /// It stands from here on.
    virtual void halted() = 0;
    /// It continues from where it stood (or runs on, if it did).
    virtual void resumed() = 0;
  };

  /// `connections`: null: no client can connect. `halted`: the processor is halted from the start.
  Clients(Target& target, Processor& processor, std::unique_ptr<Connections> connections,
          bool halted);
  Clients(const Clients&) = delete;
  Clients& operator=(const Clients&) = delete;

  /// From here on debuggers can connect.
  void open(std::unique_ptr<Connections> connections) { connections_ = std::move(connections); }
  /// Answers the packets that came.
  void serve();
  /// Until there is something to serve, or the time is over.
  void wait(std::chrono::milliseconds longest);
  bool any() const { return connections_ != nullptr && connections_->any(); }

  /// Tells those who wait that the processor stands, and why.
  void halt(const StopCause& cause);
  /// Tells them that the run is over.
  void finish(int exit_code);
  /// Text for the consoles of those who wait.
  void print(const std::string& text);

  bool is_debugged() const;
  bool is_halted() const { return halted_; }
  /// A debugger asked for the end of the run.
  bool is_killed() const { return killed_; }
  /// How the processor is to continue.
  const Resume& how() const { return how_; }

 private:
  struct Session {
    Session(std::shared_ptr<Socket> s, Target& target) : socket(std::move(s)), client(target) {}
    std::shared_ptr<Socket> socket;
    Client client;
    PacketReader reader;
    bool debugs = false;  ///< a packet came
    bool controls = false;
  };

  void begin(Session& session);
  void receive(Session& session, const std::string& bytes);
  void act(Session& session, const Request& request);
  void leave(const Socket* socket);
  void resume(const Resume& how);
  static void flush(Session& session);

  Target& target_;
  Processor& processor_;
  std::unique_ptr<Connections> connections_;
  std::list<Session> sessions_;
  Resume how_;
  StopCause cause_;
  bool halted_, killed_ = false;
};

}  // namespace capsoc::debug
