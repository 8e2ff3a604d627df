#include "armv7m/tlm/settling_turn.h"

#include <algorithm>
#include <map>

namespace capsoc::armv7m {

SettlingTurn::SettlingTurn() : kernel_(current_kernel()) {}

SettlingTurn::~SettlingTurn() {
  auto& waiting = kernel_->waiting;
  waiting.erase(std::remove(waiting.begin(), waiting.end(), this), waiting.end());
  finish();
}

/// A kernel is known by its context: SystemC has no other place for what its modules share.
std::shared_ptr<SettlingTurn::Kernel> SettlingTurn::current_kernel() {
  static std::map<const sc_core::sc_simcontext*, std::weak_ptr<Kernel>> kernels;
  std::weak_ptr<Kernel>& known = kernels[sc_core::sc_get_curr_simcontext()];
  std::shared_ptr<Kernel> kernel = known.lock();
  if (kernel == nullptr) known = kernel = std::make_shared<Kernel>();
  return kernel;
}

void SettlingTurn::pass_on() {
  kernel_->holder = kernel_->waiting.front();
  kernel_->waiting.pop_front();
  kernel_->holder->has_turn_.notify(sc_core::SC_ZERO_TIME);
}

void SettlingTurn::take() {
  give_way();
  if (kernel_->holder == nullptr) {
    kernel_->holder = this;
    return;
  }
  kernel_->waiting.push_back(this);
  sc_core::wait(has_turn_);
}

void SettlingTurn::finish() {
  if (kernel_->holder == this) kernel_->holder = nullptr;
}

}  // namespace capsoc::armv7m
