// Signals that end the program, what must not be left behind then, and one that asks it for a
// report.
#pragma once

#include <sys/types.h>

#include <string>

namespace capsoc::host {

/// Early in the program: SIGHUP, SIGINT, SIGQUIT and SIGTERM end it with exit code 128 + n, and
/// what RemovedAtSignal and EndedAtSignal name is gone. A signal that was ignored when the program
/// started (nohup, `&` of a shell) stays ignored. A file at its limit (SIGXFSZ) is an error of its
/// write; one that a library has mapped and that lost its place (SIGBUS) ends the program with a
/// sentence and `full_disk`.
void catch_end_signals(int full_disk);

/// From here on these signals are noted and nothing else, because the run asks noted_signal(): a
/// run that writes its results. A wait of the kernel that one interrupts is not resumed. SIGPIPE is
/// ignored from here on, and the writer decides what a reader that has gone means.
void note_end_signals();
/// As if the signal had come.
void note_signal(int number);
/// The last one that came; 0: none.
int noted_signal();

/// A limit of the host's time was reached.
void note_end_of_time();
/// Whether that was noted, or a signal: what still waits for a slow reader should give up.
bool is_ending();

/// From here on each of these signals calls this function, which may do what a signal handler may;
/// null: none.
void call_on_signals(void (*function)());
/// For handlers of other signals: as if one of these had come.
void call_for_signal();

/// From here on SIGUSR1 asks for a report of what is done so far, and ends nothing.
void note_report_signal();
/// Whether it came since the last call.
bool take_report_signal();

/// A file or an empty directory that is removed if a signal ends the program while this lives.
/// Otherwise it stays.
class RemovedAtSignal {
 public:
  explicit RemovedAtSignal(const std::string& path);
  ~RemovedAtSignal();
  RemovedAtSignal(RemovedAtSignal&& other) noexcept;
  RemovedAtSignal(const RemovedAtSignal&) = delete;
  RemovedAtSignal& operator=(const RemovedAtSignal&) = delete;
  RemovedAtSignal& operator=(RemovedAtSignal&&) = delete;

  struct Entry;

 private:
  Entry* entry_;  // null: the path is too long to exist, or was moved
};

/// A child process that gets SIGTERM if a signal ends the program while this lives. One at a time.
class EndedAtSignal {
 public:
  explicit EndedAtSignal(pid_t child);
  ~EndedAtSignal();
  EndedAtSignal(const EndedAtSignal&) = delete;
  EndedAtSignal& operator=(const EndedAtSignal&) = delete;
};

}  // namespace capsoc::host
