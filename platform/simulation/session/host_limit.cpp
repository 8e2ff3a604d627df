#include "session/host_limit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <utility>

#include "host/end_signals.h"

namespace capsoc::run {
namespace {

constexpr double remind_s = 0.02, shortest_s = 1e-6;

std::atomic<HostLimit*> watching{nullptr};

timespec duration(double seconds) {
  const double whole = std::floor(seconds);
  return {static_cast<time_t>(whole), static_cast<long>((seconds - whole) * 1e9)};
}

void on_alarm(int) {
  const int before = errno;
  host::call_for_signal();
  errno = before;
}

}  // namespace

std::optional<Error> HostLimit::watch(std::function<void()> call) {
  call_ = std::move(call);
  struct sigaction action {};
  action.sa_handler = on_alarm;
  sigfillset(&action.sa_mask);
  sigaction(SIGALRM, &action, nullptr);
  sigevent event{};
  event.sigev_notify = SIGEV_SIGNAL;
  event.sigev_signo = SIGALRM;
  timer_t timer{};
  if (timer_create(CLOCK_MONOTONIC, &event, &timer) != 0)
    return Error{fmt::format("no timer is left to watch for signals ({}); end other programs",
                             std::strerror(errno))};
  timer_ = timer;
  watching = this;
  host::call_on_signals(handle);
  if (seconds_ > 0) {
    const itimerspec first{{0, 0}, duration(std::max(shortest_s, seconds_ - elapsed_s()))};
    timer_settime(*timer_, 0, &first, nullptr);
  }
  if (host::noted_signal() != 0) handle();  // it came before this was ready
  return std::nullopt;
}

void HostLimit::stop_watching() {
  if (!timer_) return;
  host::call_on_signals(nullptr);
  timer_delete(*timer_);
  timer_.reset();
  watching = nullptr;
}

/// In a signal handler: the clock and the timer may be used in one.
void HostLimit::handle() {
  HostLimit& self = *watching;
  // The timer's clock may be a little ahead of this one.
  if (self.seconds_ > 0 && self.elapsed_s() + remind_s / 2 >= self.seconds_) {
    self.time_is_over_ = true;
    host::note_end_of_time();
  }
  self.unanswered_ = true;
  self.call_();
  const itimerspec again{{0, 0}, duration(remind_s)};
  timer_settime(*self.timer_, 0, &again, nullptr);
}

void HostLimit::answered() {
  if (!unanswered_ || !timer_) return;
  unanswered_ = false;
  itimerspec none{};
  if (seconds_ > 0 && !time_is_over_)
    none.it_value = duration(std::max(shortest_s, seconds_ - elapsed_s()));
  timer_settime(*timer_, 0, &none, nullptr);
}

bool HostLimit::reached() {
  out_of_time_ = time_is_over_;
  return out_of_time_ || host::noted_signal() != 0;
}

}  // namespace capsoc::run
