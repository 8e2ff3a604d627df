// capsoc run --gdb: the debugger's side of a run.
#pragma once

#include <functional>
#include <list>
#include <memory>

#include "armv7m/tlm/debugger.h"
#include "debug/client.h"
#include "debug/connections.h"
#include "debug/soc_target.h"
#include "soc/soc.h"

namespace capsoc::debug {

/// Lets any number of GDBs look at one processor. Its first packet makes a client a debugger;
/// before it, and if none ever comes (a probe of the port), a client changes nothing. The first
/// debugger halts the processor; one that comes later looks on without stopping it. Whoever resumes
/// or interrupts has it; when the last of these is gone, the run goes on by itself. Everything
/// happens in the processor's process between two instructions, and halting keeps simulated time,
/// so that looking changes no result.
class GdbServer : public armv7m::Debugger {
 public:
  /// `halted`: nothing is executed before a client says so. `give_up` ends the waiting for clients
  /// (a signal, a limit of the host's time).
  GdbServer(soc::Soc& soc, std::unique_ptr<Connections> connections, bool halted,
            std::function<bool()> give_up);
  ~GdbServer() override;
  GdbServer(const GdbServer&) = delete;
  GdbServer& operator=(const GdbServer&) = delete;

  /// Who saves the state for `monitor save`.
  void on_save(SocTarget::Saver saver) { target_.on_save(std::move(saver)); }

  /// The stimulus port of the ITM whose text the run shows.
  void show_stimulus_of(unsigned port) { target_.show_stimulus_of(port); }

  /// Tells the clients that the run is over.
  void finish(int exit_code);

  bool before_run() override;
  bool after_run(armv7m::StopReason reason, bool advanced) override;
  bool asleep_for_good() override;
  bool wants_attention() const override { return halted_ || connections_->any(); }
  bool ended() const override { return ended_; }

 private:
  struct Session {
    Session(std::shared_ptr<Socket> s, Target& target) : socket(std::move(s)), client(target) {}
    std::shared_ptr<Socket> socket;
    Client client;
    PacketReader reader;
    bool debugs = false;  ///< a packet came
    bool controls = false;
  };

  void serve();
  bool debugged() const;
  void begin(Session& session);
  void receive(Session& session, const std::string& bytes);
  void act(Session& session, const Request& request);
  void leave(const Socket* socket);
  void halt(const StopCause& cause);
  void resume(const Resume& how);
  bool step_is_over() const;
  static void flush(Session& session);

  soc::Soc& soc_;
  SocTarget target_;
  std::unique_ptr<Connections> connections_;
  std::function<bool()> give_up_;
  std::list<Session> sessions_;
  Resume how_;
  StopCause cause_;
  bool halted_, ended_ = false;
};

}  // namespace capsoc::debug
