// The connected debuggers: receives their packets, keeps which controls the processor, and notifies
// them.
#pragma once

#include <chrono>
#include <list>
#include <memory>
#include <string>
#include <utility>

#include "debug/client.h"
#include "debug/connections.h"

namespace capsoc::debug {

/// Any number of GDBs on one processor, in this or another process. A client becomes a debugger
/// with its first packet; a connection without a packet (a probe of the port) changes nothing. The
/// first debugger halts the processor; later ones observe without stopping it. A client that
/// resumes or interrupts controls the processor; when the last such client has left, the run
/// continues by itself.
class Clients {
 public:
  /// Callbacks to the processor.
  class Processor {
   public:
    virtual ~Processor() = default;
    /// The first debugger has come, or the last has left.
    virtual void debugged(bool on) = 0;
    /// The processor is halted from now on.
    virtual void halted() = 0;
    /// The processor continues, or keeps running.
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
  /// Waits until there is something to serve, at most `longest`.
  void wait(std::chrono::milliseconds longest);
  bool any() const { return connections_ != nullptr && connections_->any(); }

  /// Sends a stop reply to the debuggers that wait for one.
  void halt(const StopCause& cause);
  /// Sends them the exit code of the run.
  void finish(int exit_code);
  /// Sends text to the consoles of the debuggers that wait.
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
