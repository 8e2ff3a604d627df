// capsoc run --gdb: the debugger's side of a run.
#pragma once

#include <functional>
#include <memory>

#include "armv7m/tlm/debugger.h"
#include "debug/clients.h"
#include "debug/soc_target.h"
#include "soc/soc.h"

namespace capsoc::debug {

/// The debuggers of a run in its own process. Everything happens in the processor's process between
/// two instructions, and halting keeps simulated time, so that looking changes no result.
class GdbServer : public armv7m::Debugger, private Clients::Processor {
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
  void finish(int exit_code) { clients_.finish(exit_code); }

  bool before_run() override;
  bool after_run(armv7m::StopReason reason, bool advanced) override;
  bool asleep_for_good() override;
  bool wants_attention() const override { return clients_.is_halted() || clients_.any(); }
  bool sees_stops_alone() const override {
    return clients_.how().kind == Resume::Kind::run && !wants_attention();
  }
  bool ended() const override { return gave_up_ || clients_.is_killed(); }

 private:
  void debugged(bool on) override { soc_.cpu.core().debugging().set_halting(on); }
  void halted() override { soc_.cpu.core().debugging().set_halted(true); }
  void resumed() override;
  bool step_is_over() const;

  soc::Soc& soc_;
  SocTarget target_;
  Clients clients_;
  std::function<bool()> give_up_;
  bool gave_up_ = false;
};

}  // namespace capsoc::debug
