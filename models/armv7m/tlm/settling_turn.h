#pragma once

#include <deque>
#include <memory>
#include <systemc>

namespace capsoc::armv7m {

/// Arbitrates between the processors of one SystemC kernel that settle at an instant. A processor
/// settles by zero-time waits until the kernel has nothing pending, so that everything else at the
/// instant happens before its next instruction. Two processors that settled at once would see each
/// other's waits as activity and never end. So only one waits for the kernel, and the others wait
/// for it.
///
/// A processor whose turn is over executes. The next one gets its turn as soon as that processor
/// waits (give_way()). With one processor in the kernel there is no waiting here.
class SettlingTurn {
 public:
  SettlingTurn();
  ~SettlingTurn();
  SettlingTurn(const SettlingTurn&) = delete;
  SettlingTurn& operator=(const SettlingTurn&) = delete;

  /// Holds the turn until the end of the scope. Construct it in the processor's process, which
  /// waits, without simulated time, until it has the turn.
  class Scope {
   public:
    explicit Scope(SettlingTurn& turn) : turn_(turn) { turn_.take(); }
    ~Scope() { turn_.finish(); }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    SettlingTurn& turn_;
  };

  /// To be called before the processor's process waits, or lets other code wait in it: the next
  /// processor settles meanwhile.
  void give_way() {
    if (!kernel_->waiting.empty() && kernel_->holder == nullptr) pass_on();
  }

 private:
  /// What the processors of one kernel share.
  struct Kernel {
    SettlingTurn* holder = nullptr;
    std::deque<SettlingTurn*> waiting;
  };

  static std::shared_ptr<Kernel> current_kernel();
  void pass_on();
  void take();
  void finish();

  std::shared_ptr<Kernel> kernel_;
  sc_core::sc_event has_turn_;
};

}  // namespace capsoc::armv7m
