#include "host/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <initializer_list>

#include "host/descriptor.h"
#include "host/end_signals.h"

namespace capsoc::host {

void end_with_parent(pid_t parent, int code) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  // One that was killed before this call has left already.
  if (getppid() != parent) _exit(code);
}

pid_t fork_beside() {
  // Without a stack of its own the child continues on a copy of this one.
  return static_cast<pid_t>(syscall(SYS_clone, CLONE_PARENT | SIGCHLD, 0, 0, 0, 0));
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

Apart perform_apart(const std::function<std::string()>& work) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return {};
  const Descriptor said(ends[0]);
  Descriptor says(ends[1]);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) return {};
  if (child == 0) {
    end_with_parent(parent, 1);
    _exit(write_all(says.get(), work()) ? 0 : 1);
  }
  says.reset();
  Apart apart;
  char buffer[4096];
  for (;;) {
    // A signal may have come just before, and interrupts nothing then.
    constexpr int look_ms = 50;
    pollfd heard{said.get(), POLLIN, 0};
    const bool is_heard = poll(&heard, 1, look_ms) > 0;
    if (noted_signal() != 0) kill(child, SIGKILL);
    if (!is_heard) continue;
    const ssize_t count = read(said.get(), buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    apart.text.append(buffer, static_cast<std::size_t>(count));
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const bool has_finished = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  apart.end = has_finished ? Apart::End::finished : Apart::End::crashed;
  return apart;
}

}  // namespace capsoc::host
