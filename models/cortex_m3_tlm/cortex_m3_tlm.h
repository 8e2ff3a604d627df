// TLM-2.0 shell of the Cortex-M3: three AHB-Lite ports, interrupt lines, and the core's cycles tied
// to simulated time.
//
// The quantum is a speed knob and nothing else. The core never runs past the kernel's next pending
// activity, and before an access to a device it synchronises, or is sure that the device may be
// told the time of the access instead. So every model sees every access at its exact time, and
// every interrupt reaches the core at the instruction it would reach without temporal decoupling.
#pragma once

#include <tlm_utils/simple_initiator_socket.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <systemc>
#include <vector>

#include "cortex_m3/core.h"
#include "cortex_m3_tlm/debugger.h"
#include "cortex_m3_tlm/end_on_idle.h"
#include "cortex_m3_tlm/polling_watch.h"
#include "kit/clock_domain.h"
#include "kit/component.h"
#include "kit/early_write.h"
#include "kit/steady_read.h"

namespace capsoc::cortex_m3 {

/// Why the processor ended the simulation.
enum class EndReason { none, exit, lockup, stuck, asleep, end_on_idle, interrupted, debugger };

/// The processor as a bus master.
class CortexM3Tlm : public sc_core::sc_module, public kit::Component, private Bus {
 public:
  using Socket = tlm_utils::simple_initiator_socket_tagged<CortexM3Tlm, 32>;

  Socket icode;   ///< instruction fetches below 0x20000000
  Socket dcode;   ///< data accesses below 0x20000000
  Socket system;  ///< everything else

  CortexM3Tlm(const sc_core::sc_module_name& name, kit::ClockDomain& clock);
  ~CortexM3Tlm() override;

  /// How far the core may run ahead of the kernel.
  void set_quantum(const sc_core::sc_time& quantum) { quantum_ = quantum; }
  /// Whether the turns of a loop that only waits for a device are skipped as far as nothing can
  /// happen, and what such loops do beside is done without the kernel where it may be. It changes
  /// nothing but the host's time.
  void set_fast_forward(bool on) { fast_forward_ = on; }
  /// Called for SYSRESETREQ and request_reset(), at that time; resets the rest of the system.
  void on_reset_request(std::function<void()> callback) { reset_request_ = std::move(callback); }
  /// A level on an interrupt line.
  void set_interrupt(unsigned line, bool level);
  /// A rising edge of the NMI input.
  void pulse_nmi();
  /// A system reset from outside (a watchdog, a pin), before the next instruction.
  void request_reset();

  Core& core() { return core_; }
  const Core& core() const { return core_; }
  EndReason end_reason() const { return end_reason_; }

  /// What the access that is on a socket now is for; nothing: it is not the core's (a debugger's).
  std::optional<AccessKind> accessing() const { return accessing_; }

  /// Asked again and again while the core executes, hundreds of thousands of cycles apart at the
  /// most, and soon after interrupt() whatever the core does: true ends the simulation (a limit of
  /// the host's time, a signal).
  void set_interrupted(std::function<bool()> interrupted) { interrupted_ = std::move(interrupted); }
  /// Has that asked soon by a core that executes. A signal handler may call it.
  void interrupt() { called_.store(true, std::memory_order_relaxed); }
  /// The same for a core that sleeps, which may be at any simulated time: for whoever runs the
  /// kernel, while it is paused.
  void wake_if_interrupted() {
    if (is_called()) wake_.notify(sc_core::SC_ZERO_TIME);
  }

  /// Behind the end of the simulation: a core that sleeps has done so until now, whoever woke it
  /// in between.
  void count_sleep() { catch_up(); }

  /// Ends the simulation when the program has been idle for so long (end_on_idle.h).
  void set_end_on_idle(EndOnIdle rule) { end_on_idle_.emplace(std::move(rule)); }
  /// The program did something at this instant that is seen outside: it is not idle.
  void note_work();

  /// Called between two instructions, with the core and the kernel at one instant, the first at or
  /// after the time that was asked for; asleep counts as between. Returns when it wants to be
  /// called again, sc_max_time(): never. It changes nothing in the simulation.
  using Pause = std::function<sc_core::sc_time(const sc_core::sc_time& now)>;
  void set_pause(const sc_core::sc_time& first, Pause pause);
  /// The pause is wanted now, from within a call that the processor makes.
  void pause_now() {
    pause_at_ = sc_core::SC_ZERO_TIME;
    set_bounds();
  }
  /// Instead of a reset at time 0: nothing happens until `time`, when `load` gives the system its
  /// state back. False ends the simulation.
  void resume_at(const sc_core::sc_time& time, std::function<bool()> load);
  bool waits_for_resume() const { return static_cast<bool>(load_); }

  const char* component_name() const override { return basename(); }
  /// The processor's part of a system reset is the caller of on_reset_request()'s.
  void reset() override {}
  void visit(kit::Archive& archive) override;
  void restored() override;

  /// Asked before and told after every run of the core; null: nobody. It stays the caller's.
  void set_debugger(Debugger* debugger) { debugger_ = debugger; }
  /// A system reset at once; for the debugger, out of its calls.
  void reset_now() { reset_system(); }

 private:
  /// What an access came to.
  struct Transfer {
    uint32_t address, size, value, wait_cycles;
    bool operator==(const Transfer& other) const {
      return address == other.address && size == other.size && value == other.value &&
             wait_cycles == other.wait_cycles;
    }
  };

  void thread();
  bool is_called() const { return called_.load(std::memory_order_relaxed); }
  bool is_interrupted();
  void sleep();
  void sleep_until_woken();
  void look_ahead();
  void set_bounds();
  bool is_late() const;
  void let_kernel_run(const sc_core::sc_time& time);
  void synchronise();
  void let_kernel_follow();
  void catch_up();
  void settle();
  bool skip_known_turns();
  void skip_polling();
  void end(EndReason reason);
  bool begin();
  void pause_if_due();
  void reset_system();
  bool access(tlm::tlm_command command, uint32_t address, unsigned size, uint32_t& value,
              unsigned& wait_cycles, AccessKind kind);
  unsigned transport(uint32_t address, AccessKind kind);
  unsigned send(uint32_t address, AccessKind kind, bool ahead);
  bool may_be_ahead(uint32_t address, AccessKind kind) const;
  bool holds(uint32_t address, unsigned size) const;
  void note_access(const Transfer& access, bool steady);
  bool map_if_memory(uint32_t address, AccessKind kind);
  void invalidate(int port, sc_dt::uint64 first, sc_dt::uint64 last);
  Socket& port(uint32_t address, AccessKind kind);

  bool read(uint32_t address, unsigned size, uint32_t& value, unsigned& wait_cycles,
            AccessKind kind) override;
  bool write(uint32_t address, unsigned size, uint32_t value, unsigned& wait_cycles) override;

  kit::ClockDomain& clock_;
  Core core_;
  sc_core::sc_time quantum_{1, sc_core::SC_MS};
  sc_core::sc_time looked_at_;      // when the kernel was asked last, behind an access or a wait:
  sc_core::sc_time next_activity_;  // its next one, which does not come near by itself
  uint64_t late_from_ = 0;          // the first cycle at or behind which the kernel has to go on
  uint64_t limit_ = 0;              // the first cycle that the core may not pass without it
  uint64_t horizon_ = 0;            // the limit of the run that goes on
  sc_core::sc_event wake_;
  std::atomic<bool> called_{false};  // by interrupt()
  uint64_t asked_at_ = 0;            // the cycle at which interrupted_ was asked last
  std::function<void()> reset_request_;
  std::function<bool()> interrupted_;
  EndReason end_reason_ = EndReason::none;
  Debugger* debugger_ = nullptr;
  tlm::tlm_generic_payload payload_;  // of all accesses: making one costs as much as an access
  kit::SteadyRead steady_;            // on the payload: of the last read
  kit::EarlyWrite early_;             // on the payload: of the last write
  std::optional<uint32_t> steady_address_;  // of the last steady read
  std::optional<uint32_t> early_address_;   // of the last write that was taken early, or would be
  unsigned early_size_ = 0;
  bool measuring_ = false;     // a turn of a loop
  uint64_t steady_until_ = 0;  // the cycle until which all reads of a turn stay as they are
  PollingWatch polling_;
  std::optional<Transfer> latest_;        // only a steady read is one of a turn
  bool latest_holds_ = false;             // it was a steady read, and the kernel has not gone on
  std::optional<Transfer> read_of_turn_;  // the only one of the turn measured last
  std::array<uint64_t, 2> read_at_{};     // the cycles of the latest two while a turn is measured
  bool seems_to_poll_ = false;            // worth a look behind the run
  bool fast_forward_ = true;
  bool reset_requested_ = false;
  std::optional<AccessKind> accessing_;
  /// Direct memory that was granted: the first access to it went over the bus and took its time.
  struct Granted {
    uint32_t address = 0;
    AccessKind kind = AccessKind::load;
    void visit(kit::Archive& archive) {
      archive("address", address);
      archive.at_most("kind", kind, AccessKind::store);
    }
  };
  std::vector<Granted> granted_;
  std::optional<EndOnIdle> end_on_idle_;
  sc_core::sc_time pause_at_ = sc_core::sc_max_time();
  Pause pause_;
  sc_core::sc_time resume_at_;
  std::function<bool()> load_;  // empty: nothing to be loaded, or it is
};

}  // namespace capsoc::cortex_m3
