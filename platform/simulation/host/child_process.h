// What a process is to be that was just forked.
#pragma once

#include <sys/types.h>

#include <functional>
#include <string>

namespace capsoc::host {

/// It ends with its parent, even if that is killed. Exits with the code if the parent has gone
/// already.
void end_with_parent(pid_t parent, int code);

/// As fork(), and the child has this process's parent as its own. Of a process with one thread; no
/// handler of pthread_atfork() is called.
pid_t fork_beside();

/// It leads a process group, so that the keyboard's signals are its parent's alone; standard input
/// and output are /dev/null; a crash leaves no core file.
void leave_terminal();

/// How work in a process apart ended.
struct Apart {
  enum class End { finished, crashed, not_started };
  End end = End::not_started;
  std::string text;  ///< of one that finished
};
/// Does `work` in a fork of this process, which ends with it. A signal that was noted
/// (host::noted_signal()) ends it at once, as a crash.
Apart perform_apart(const std::function<std::string()>& work);

}  // namespace capsoc::host
