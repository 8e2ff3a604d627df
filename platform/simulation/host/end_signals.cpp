#include "host/end_signals.h"

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <climits>
#include <csignal>
#include <cstring>
#include <utility>

namespace capsoc::host {

/// In a list that only grows, for a signal handler may walk it at any moment; entries are used
/// again.
struct RemovedAtSignal::Entry {
  std::atomic<bool> taken{true};
  std::atomic<bool> named{false};
  char path[PATH_MAX] = {};
  Entry* next = nullptr;
};

namespace {

constexpr int end_signals[] = {SIGHUP, SIGINT, SIGQUIT, SIGTERM};

std::atomic<RemovedAtSignal::Entry*> entries{nullptr};
std::atomic<pid_t> child_process{0};
std::atomic<int> noted{0};
std::atomic<void (*)()> called_on_signals{nullptr};
std::atomic<bool> out_of_time{false};
std::atomic<int> exit_without_room{0};
std::atomic<bool> report_asked{false};

constexpr int look_every_ms = 10, longest_goodbye_ms = 2000;

/// Until it is gone: what it still writes may be in a folder that is to be removed.
void end_child(pid_t child) {
  kill(child, SIGTERM);
  for (int waited_ms = 0; waitpid(child, nullptr, WNOHANG) == 0; waited_ms += look_every_ms) {
    if (waited_ms >= longest_goodbye_ms) kill(child, SIGKILL);
    poll(nullptr, 0, look_every_ms);
  }
}

// Only calls that a signal handler may make.
void clean_up() {
  if (const pid_t child = child_process; child > 0) end_child(child);
  for (const auto* entry = entries.load(); entry != nullptr; entry = entry->next)
    if (entry->named) unlink(entry->path);
  for (const auto* entry = entries.load(); entry != nullptr; entry = entry->next)
    if (entry->named) rmdir(entry->path);
}

void end_now(int number) {
  clean_up();
  _exit(128 + number);
}

// GTKWave's library maps temporary files, whose pages need room on the disk when they are touched.
void end_without_room(int) {
  clean_up();
  constexpr char words[] =
      "capsoc: a temporary file lost its place: the disk of /tmp or of the waves is full; make "
      "room\n";
  if (write(STDERR_FILENO, words, sizeof words - 1) < 0) _exit(exit_without_room);
  _exit(exit_without_room);
}

void note(int number) {
  noted = number;
  call_for_signal();
}

void handle(void (*handler)(int)) {
  for (const int number : end_signals) {
    struct sigaction before {};
    if (sigaction(number, nullptr, &before) != 0 || before.sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = handler;
    sigfillset(&action.sa_mask);
    sigaction(number, &action, nullptr);
  }
}

}  // namespace

void catch_end_signals(int full_disk) {
  exit_without_room = full_disk;
  handle(end_now);
  std::signal(SIGBUS, end_without_room);
  std::signal(SIGXFSZ, SIG_IGN);  // a file at its limit is an error of its write
}

void note_end_signals() {
  handle(note);
  std::signal(SIGPIPE, SIG_IGN);
}

void note_signal(int number) {
  note(number);
}

int noted_signal() {
  return noted;
}

void note_end_of_time() {
  out_of_time = true;
}

bool is_ending() {
  return out_of_time || noted != 0;
}

void call_on_signals(void (*function)()) {
  called_on_signals = function;
}

void call_for_signal() {
  if (void (*const function)() = called_on_signals) function();
}

void note_report_signal() {
  struct sigaction action {};
  action.sa_handler = [](int) { report_asked = true; };
  action.sa_flags = SA_RESTART;
  sigfillset(&action.sa_mask);
  sigaction(SIGUSR1, &action, nullptr);
}

bool take_report_signal() {
  return report_asked.exchange(false);
}

RemovedAtSignal::RemovedAtSignal(const std::string& path) : entry_(nullptr) {
  if (path.size() >= PATH_MAX) return;
  for (Entry* entry = entries.load(); entry != nullptr && entry_ == nullptr; entry = entry->next)
    if (!entry->taken.exchange(true)) entry_ = entry;
  if (entry_ == nullptr) {
    entry_ = new Entry;
    entry_->next = entries;
    while (!entries.compare_exchange_weak(entry_->next, entry_)) {
    }
  }
  std::memcpy(entry_->path, path.c_str(), path.size() + 1);
  entry_->named = true;
}

RemovedAtSignal::RemovedAtSignal(RemovedAtSignal&& other) noexcept
    : entry_(std::exchange(other.entry_, nullptr)) {}

RemovedAtSignal::~RemovedAtSignal() {
  if (entry_ == nullptr) return;
  entry_->named = false;
  entry_->taken = false;
}

EndedAtSignal::EndedAtSignal(pid_t child) {
  child_process = child;
}

EndedAtSignal::~EndedAtSignal() {
  child_process = 0;
}

}  // namespace capsoc::host
