#include "workers/command.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "base/printable.h"
#include "host/child_process.h"
#include "host/descriptor.h"

namespace capsoc::workers {
namespace {

constexpr const char* shell = "/bin/sh";
constexpr std::size_t longest_output = std::size_t{16} << 20U;
constexpr std::size_t longest_sentence = 200;
constexpr int no_shell = 127;  // as shells have it
constexpr int signalled = 128;

/// In the new process: what a worker keeps from itself is a program's again.
[[noreturn]] void become(const std::vector<const char*>& words, const Variables& variables,
                         pid_t parent, int output, int captured) {
  host::end_with_parent(parent, no_shell);
  for (const int number : {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGUSR1, SIGPIPE})
    std::signal(number, SIG_DFL);
  dup2(output, captured);
  for (const auto& [name, value] : variables) setenv(name.c_str(), value.c_str(), 1);
  execv(shell, const_cast<char* const*>(words.data()));
  _exit(no_shell);
}

/// Until its end; what is beyond the longest is not kept.
std::string read_all(int from) {
  std::string text;
  char buffer[65536];
  for (;;) {
    const ssize_t count = read(from, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return text;
    if (text.size() <= longest_output) text.append(buffer, static_cast<std::size_t>(count));
  }
}

Result<CommandEnd> run(std::vector<const char*> words, const Variables& variables, int captured) {
  words.push_back(nullptr);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    return Error{fmt::format("a command cannot be started ({})", std::strerror(errno))};
  const host::Descriptor from(ends[0]);
  host::Descriptor to(ends[1]);
  const pid_t parent = getpid();
  const pid_t process = fork();
  if (process == 0) become(words, variables, parent, to.get(), captured);
  if (process < 0)
    return Error{fmt::format("a command cannot be started ({})", std::strerror(errno))};
  to.reset();
  CommandEnd end;
  end.output = read_all(from.get());
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  end.code = WIFSIGNALED(status) ? signalled + WTERMSIG(status) : WEXITSTATUS(status);
  if (end.output.size() > longest_output)
    return Error{fmt::format("the command prints more than {} MiB; print the result alone",
                             longest_output >> 20U)};
  return end;
}

}  // namespace

Result<CommandEnd> run_command(const std::string& line, const Variables& variables) {
  return run({shell, "-c", line.c_str()}, variables, STDOUT_FILENO);
}

std::optional<Error> check_command(const std::string& line) {
  auto end = run({shell, "-n", "-c", line.c_str()}, {}, STDERR_FILENO);
  if (!end) return Error{end.error()};
  if (end.value().code == 0) return std::nullopt;
  std::string& said = end.value().output;
  while (!said.empty() && said.back() == '\n') said.pop_back();
  return Error{printable(said, longest_sentence)};
}

}  // namespace capsoc::workers
