// Signals that end the program, cleanup on them, and a signal that requests a report.
#pragma once

#include <sys/types.h>

#include <string>

namespace capsoc::host {

/// Call early in the program. SIGHUP, SIGINT, SIGQUIT and SIGTERM then end it with exit code 128 +
/// n, after the cleanup of RemovedAtSignal and EndedAtSignal. A signal that was ignored when the
/// program started (nohup, `&` of a shell) stays ignored. A file at its size limit (SIGXFSZ) is an
/// error of its write. A lost page of a file that a library has mapped (SIGBUS, a full disk) ends
/// the program with a sentence and the exit code `full_disk`.
void catch_end_signals(int full_disk);

/// From now on these signals are only recorded, and the run polls noted_signal(), so that it can
/// write its results. An interrupted system call is not restarted. SIGPIPE is ignored from now on;
/// the writer handles a reader that is gone.
void note_end_signals();
/// As if the signal had come.
void note_signal(int number);
/// The latest signal; 0: none.
int noted_signal();

/// A limit of the host's time was reached.
void note_end_of_time();
/// True after either, or after a signal: waits for a slow reader should give up.
bool is_ending();

/// From now on each of these signals calls this function, which must be async-signal-safe; null:
/// none.
void call_on_signals(void (*function)());
/// Calls that function, from handlers of other signals.
void call_for_signal();

/// From now on SIGUSR1 requests a report of the progress, and does not end the program.
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
