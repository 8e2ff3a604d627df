// What a process is to be that was just forked.
#pragma once

#include <sys/types.h>

namespace capsoc::host {

/// It ends with its parent, even if that is killed. Exits with the code if the parent has gone
/// already.
void end_with_parent(pid_t parent, int code);

/// It leads a process group, so that the keyboard's signals are its parent's alone; standard input
/// and output are /dev/null; a crash leaves no core file.
void leave_terminal();

}  // namespace capsoc::host
