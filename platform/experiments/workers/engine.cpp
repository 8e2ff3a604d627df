#include "workers/engine.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <utility>

#include "host/child_process.h"
#include "host/descriptor.h"
#include "host/end_signals.h"

namespace capsoc::workers {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int tick_ms = 200;
constexpr std::size_t longest_log = 4000;
constexpr std::size_t longest_result = std::size_t{64} << 20U;
constexpr rlim_t largest_written = rlim_t{8}
                                   << 30U;  // of a worker's: a log or waves without an end

/// What the first byte of a worker's answer says.
enum class Answer : char { result = 'R', refusal = 'E', no_memory = 'M' };

int answer_descriptor = -1;  // of this process, if it is a worker

void answer(Answer kind, std::string_view text) {
  std::string all(1, static_cast<char>(kind));
  all += text;
  if (!host::write_all(answer_descriptor, all)) _exit(1);
}

[[noreturn]] void out_of_memory() {
  const char word = static_cast<char>(Answer::no_memory);
  _exit(write(answer_descriptor, &word, 1) == 1 ? 0 : 1);
}

void limit(__rlimit_resource_t resource, rlim_t value) {
  rlimit both{};
  if (getrlimit(resource, &both) != 0) return;
  both.rlim_max = both.rlim_cur = std::min(value, both.rlim_max);
  setrlimit(resource, &both);
}

/// What this process shall not do to others, nor others to its result.
void become_worker(pid_t parent, int log, [[maybe_unused]] const Limits& limits) {
  host::end_with_parent(parent, 1);
  // The parent ends the workers; half a run is no result.
  host::leave_terminal();
  for (const int number : {SIGTERM, SIGUSR1}) std::signal(number, SIG_IGN);
  dup2(log, STDERR_FILENO);
  limit(RLIMIT_FSIZE, largest_written);
#ifndef __SANITIZE_ADDRESS__  // whose shadow is terabytes of address space
  limit(RLIMIT_AS, static_cast<rlim_t>(limits.memory_mib) << 20U);
#endif
  std::set_new_handler(out_of_memory);
}

[[noreturn]] void work(const Engine::Perform& perform, std::size_t task) {
  try {
    const auto result = perform(task);
    answer(result ? Answer::result : Answer::refusal, result ? result.value() : result.error());
    _exit(0);
  } catch (const std::bad_alloc&) {
    out_of_memory();
  } catch (const std::exception& error) {
    const std::string text = fmt::format("internal error: {}\n", error.what());
    _exit(write(STDERR_FILENO, text.data(), text.size()) < 0 ? 1 : 70);
  }
}

/// The last bytes, from the begin of a line.
std::string end_of(int file) {
  const off_t size = lseek(file, 0, SEEK_END);
  const auto from = std::max<off_t>(0, size - static_cast<off_t>(longest_log));
  std::string text(static_cast<std::size_t>(std::max<off_t>(0, size - from)), '\0');
  const ssize_t count = pread(file, text.data(), text.size(), from);
  text.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  if (from > 0) text.erase(0, std::min(text.size(), text.find('\n') + 1));
  return text;
}

/// With all that it started: a worker leads its own group.
void end_at_once(pid_t worker) {
  kill(-worker, SIGKILL);
  kill(worker, SIGKILL);  // it may not be there yet
}

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

Error no_process(int error) {
  return Error{
      fmt::format("a worker cannot be started ({}); give fewer --jobs", std::strerror(error))};
}

}  // namespace

const char* const finished = "finished";

struct Engine::Worker {
  pid_t process;
  std::size_t task;
  int answer, log;  // descriptors to read from
  Clock::time_point begin;
  std::string text = {};
  bool closed = false;  // has said all it will
  bool out_of_time = false;

  double left(const Limits& limits) const { return limits.seconds - seconds_since(begin); }

  void read_some() {
    char buffer[65536];
    const ssize_t count = read(answer, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) return;
    closed = count <= 0;
    if (!closed) text.append(buffer, static_cast<std::size_t>(count));
    if (text.size() <= longest_result) return;
    end_at_once(process);
    closed = true;
  }

  /// Waits for its end; `status` as waitpid has it.
  Ended end(int status) const {
    Ended ended{task, "", "", end_of(log), seconds_since(begin)};
    const char kind = text.empty() ? '\0' : text.front();
    if (out_of_time)
      ended.ending = "out of time";
    else if (kind == static_cast<char>(Answer::no_memory))
      ended.ending = "out of memory";
    else if (WIFSIGNALED(status))
      ended.ending = fmt::format("crashed: signal {}", WTERMSIG(status));
    else if (WEXITSTATUS(status) != 0 || kind == '\0')
      ended.ending = fmt::format("crashed: exit {}", WEXITSTATUS(status));
    else if (kind == static_cast<char>(Answer::refusal))
      ended.ending = "refused: " + text.substr(1);
    else
      ended.ending = finished;
    if (ended.ending == finished) ended.result = text.substr(1);
    return ended;
  }
};

Engine::Engine(unsigned jobs, const Limits& limits, Perform perform)
    : jobs_(jobs), limits_(limits), perform_(std::move(perform)) {}

Engine::~Engine() {
  end_all();
}

std::optional<Error> Engine::start(std::size_t task) {
  int answers[2];
  if (pipe2(answers, O_CLOEXEC) != 0) return no_process(errno);
  const int log = memfd_create("log", MFD_CLOEXEC);
  const pid_t parent = getpid();
  const pid_t process = log < 0 ? -1 : fork();
  if (process == 0) {
    close(answers[0]);
    answer_descriptor = answers[1];
    become_worker(parent, log, limits_);
    work(perform_, task);
  }
  const int error = errno;
  close(answers[1]);
  if (process < 0) {
    close(answers[0]);
    if (log >= 0) close(log);
    return no_process(error);
  }
  workers_.push_back({process, task, answers[0], log, Clock::now()});
  return std::nullopt;
}

std::optional<Error> Engine::refill(const std::vector<std::size_t>& tasks, std::size_t& next) {
  while (workers_.size() < jobs_ && next < tasks.size()) {
    if (auto error = start(tasks[next])) {
      if (workers_.empty()) return error;
      return std::nullopt;  // with fewer, then: one of these makes room
    }
    ++next;
  }
  return std::nullopt;
}

void Engine::wait() {
  std::vector<pollfd> descriptors;
  double timeout_ms = tick_ms;
  for (const Worker& worker : workers_) {
    descriptors.push_back({worker.answer, POLLIN, 0});
    timeout_ms = std::clamp(worker.left(limits_) * 1e3 + 1, 0.0, timeout_ms);
  }
  const int ready = poll(descriptors.data(), descriptors.size(), static_cast<int>(timeout_ms));
  for (std::size_t i = 0; i < workers_.size(); ++i) {
    Worker& worker = workers_[i];
    if (ready > 0 && descriptors[i].revents != 0) {
      worker.read_some();  // in time, even if this process slept
      continue;
    }
    if (worker.left(limits_) > 0) continue;
    worker.out_of_time = worker.closed = true;
    end_at_once(worker.process);
  }
}

std::vector<Ended> Engine::reap() {
  std::vector<Ended> ended;
  for (std::size_t i = 0; i < workers_.size();) {
    Worker& worker = workers_[i];
    if (!worker.closed) {
      ++i;
      continue;
    }
    // What it left behind is ended while its number, the group's, is still taken.
    siginfo_t gone{};
    while (waitid(P_PID, static_cast<id_t>(worker.process), &gone, WEXITED | WNOWAIT) < 0 &&
           errno == EINTR) {
    }
    kill(-worker.process, SIGKILL);
    int status = 0;
    while (waitpid(worker.process, &status, 0) < 0 && errno == EINTR) {
    }
    ended.push_back(worker.end(status));
    close(worker.answer);
    close(worker.log);
    workers_.erase(workers_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return ended;
}

void Engine::end_all() {
  for (Worker& worker : workers_) {
    end_at_once(worker.process);
    worker.closed = true;
  }
  reap();
}

std::optional<Error> Engine::perform(const std::vector<std::size_t>& tasks, const Take& take,
                                     const Tick& tick) {
  std::size_t next = 0;
  auto last_tick = Clock::now();
  while ((next < tasks.size() || !workers_.empty()) && host::noted_signal() == 0) {
    if (auto error = refill(tasks, next)) return error;
    wait();
    std::vector<Ended> ended = reap();
    if (host::noted_signal() != 0) break;
    // The next ones work while the disk does.
    if (auto error = refill(tasks, next)) return error;
    for (Ended& each : ended)
      if (auto error = take(std::move(each))) return error;
    if (seconds_since(last_tick) * 1e3 < tick_ms) continue;
    tick(workers_.size());
    last_tick = Clock::now();
  }
  end_all();
  return std::nullopt;
}

}  // namespace capsoc::workers
