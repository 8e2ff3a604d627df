#include "service/ticker.h"

#include <algorithm>
#include <atomic>
#include <cerrno>

namespace capsoc::service {
namespace {

constexpr uint64_t shortest_ns = 20'000'000, ns_per_s = 1'000'000'000;
/// A snapshot takes 1/50 of the processor time at most.
constexpr uint64_t share = 50;

std::atomic<run::Simulation*> ticking{nullptr};
std::atomic<bool> is_due{false};

int tick_signal() {
  return SIGRTMIN;
}

void on_tick(int) {
  const int before = errno;
  is_due = true;
  if (run::Simulation* const simulation = ticking) simulation->interrupt();
  errno = before;
}

}  // namespace

uint64_t processor_time_ns() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<uint64_t>(now.tv_sec) * ns_per_s + static_cast<uint64_t>(now.tv_nsec);
}

Ticker::Ticker(run::Simulation& simulation) : interval_ns_(shortest_ns) {
  struct sigaction action {};
  action.sa_handler = on_tick;
  action.sa_flags = SA_RESTART;
  sigaction(tick_signal(), &action, nullptr);
  sigevent event{};
  event.sigev_notify = SIGEV_SIGNAL;
  event.sigev_signo = tick_signal();
  timer_t timer{};
  if (timer_create(CLOCK_PROCESS_CPUTIME_ID, &event, &timer) == 0) timer_ = timer;
  ticking = &simulation;
}

Ticker::~Ticker() {
  set(false);
  ticking = nullptr;
  if (timer_) timer_delete(*timer_);
}

void Ticker::set(bool on) {
  if (!timer_) return;
  itimerspec when{};
  if (on)
    when.it_interval = when.it_value = {static_cast<time_t>(interval_ns_ / ns_per_s),
                                        static_cast<long>(interval_ns_ % ns_per_s)};
  timer_settime(*timer_, 0, &when, nullptr);
}

bool Ticker::take() {
  return is_due.exchange(false);
}

void Ticker::took(uint64_t ns) {
  interval_ns_ = std::max(shortest_ns, share * ns);
  set(true);
}

}  // namespace capsoc::service
