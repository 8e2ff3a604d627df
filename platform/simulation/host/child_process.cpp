#include "host/child_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <initializer_list>

namespace capsoc::host {

void end_with_parent(pid_t parent, int code) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  // One that was killed before this call has left already.
  if (getppid() != parent) _exit(code);
}

void leave_terminal() {
  setpgid(0, 0);
  for (const int number : {SIGHUP, SIGINT, SIGQUIT}) std::signal(number, SIG_IGN);
  const int nothing = open("/dev/null", O_RDWR);
  dup2(nothing, STDIN_FILENO);
  dup2(nothing, STDOUT_FILENO);
  const rlimit none{};
  setrlimit(RLIMIT_CORE, &none);
}

}  // namespace capsoc::host
