#include "service/worker.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <functional>
#include <map>
#include <new>
#include <string_view>

#include "host/child_process.h"
#include "host/end_signals.h"
#include "service/board.h"
#include "service/board_verbs.h"

namespace capsoc::service {
namespace {

constexpr int interrupt_signal = SIGUSR2;

/// Of this process, if it is a worker; for the signal's handler.
Shared* to_be_interrupted = nullptr;
std::atomic<uint64_t> current_call{0};
std::atomic<run::Simulation*> current_simulation{nullptr};

void interrupt_current(int) {
  run::Simulation* const simulation = current_simulation;
  const uint64_t call = current_call;
  if (simulation != nullptr && call != 0 && to_be_interrupted->interrupted_call == call)
    simulation->interrupt();
}

void catch_interruptions() {
  struct sigaction action {};
  action.sa_handler = interrupt_current;
  action.sa_flags = SA_RESTART;
  sigaction(interrupt_signal, &action, nullptr);
}

/// An answer as it goes to the session; one that no client may be sent is refused.
std::string bytes_of(uint64_t call, const Answer& answer) {
  std::string bytes =
      answer.ok()
          ? to_bytes({{{"call", call}, {"result", answer.result}}, answer.frames})
          : to_bytes({{{"call", call}, {"error", error_of(answer.code, answer.sentence)}}, {}});
  if (bytes.find('\n') <= MessageReader::longest_line) return bytes;
  return bytes_of(call, refuse("the answer has more than 16 MiB of text; ask for a part of it, or "
                               "read memory"));
}

class Worker {
 public:
  explicit Worker(int connection) : connection_(connection) {}

  [[noreturn]] void serve() {
    for (;;) {
      while (auto incoming = reader_.next()) {
        if (!incoming->message) _exit(1);  // the session writes no such thing
        take(*incoming->message);
      }
      receive();
    }
  }

 private:
  void receive() {
    char buffer[65536];
    const ssize_t count = read(connection_, buffer, sizeof buffer);
    if (count > 0) return reader_.feed({buffer, static_cast<std::size_t>(count)});
    if (count < 0 && errno == EINTR && host::noted_signal() == 0) return;
    leave();
  }

  /// The session has gone, or has no use for it, or a signal ended it: outputs are written.
  [[noreturn]] void leave() {
    if (board_ != nullptr) board_->finish();
    _exit(0);
  }

  void send(const std::string& bytes) {
    if (!host::write_all(connection_, bytes)) leave();
  }

  void take(Message& message) {
    const auto call = message.body.at("call").get<uint64_t>();
    current_call = call;
    if (board_ != nullptr && !board_->is_finished()) board_->simulation().take_interruption();
    Answer answer = perform(message);
    current_call = 0;
    send(bytes_of(call, answer));
  }

  /// What nobody foresaw is an answer, too.
  Answer perform(Message& message) {
    try {
      return perform_method(message);
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      return refuse(fmt::format("internal error: {}", error.what()));
    }
  }

  Answer perform_method(Message& message) {
    const auto method = message.body.at("method").get<std::string>();
    const Json& parameters = message.body.at("params");
    if (method == construct_method) return construct(parameters, message.frames);
    if (board_ == nullptr) return refuse("the simulation was not constructed");
    if (to_be_interrupted->interrupted_call == current_call && method == "simulation.advance")
      return interrupted_before();
    if (method == snapshot_method) return snapshot();
    for (const BoardVerb& verb : board_verbs())
      if (verb.about.method == method) return perform(verb, parameters, message.frames);
    return refuse("there is no method " + method, Code::unknown_method);
  }

  Answer perform(const BoardVerb& verb, const Json& parameters, const Frames& frames) {
    const Call call(verb.about, parameters, frames);
    if (std::string complaint = call.complaint(); !complaint.empty())
      return refuse(std::move(complaint), Code::wrong_parameter);
    if (board_->is_finished() && !verb.after_the_end)
      return refuse(verb.about.method + ": the simulation is finished", Code::over);
    return verb.perform(*board_, call);
  }

  Answer interrupted_before() {
    Answer answer;
    answer.result = {
        {"state", board_->state()}, {"reason", "interrupted"}, {"events", Json::array()}};
    return answer;
  }

  Answer construct(const Json& parameters, Frames& frames) {
    Board::Snapshot from;
    if (!frames.empty()) from = {parameters.at("held"), std::move(frames)};
    auto board = Board::construct(parameters.at("settings"), from);
    if (!board) return refuse(board.error());
    board_ = std::move(board.value());
    current_simulation = &board_->simulation();
    Answer answer;
    answer.result["state"] = board_->state();
    return answer;
  }

  Answer snapshot() {
    auto snapshot = board_->is_finished() ? Result<Board::Snapshot>(Error{"it is finished"})
                                          : board_->snapshot();
    if (!snapshot) return refuse("no snapshot: " + snapshot.error());
    Answer answer;
    answer.result["held"] = std::move(snapshot.value().held);
    answer.frames = std::move(snapshot.value().frames);
    return answer;
  }

  int connection_;
  MessageReader reader_;
  std::unique_ptr<Board> board_;
};

[[noreturn]] void work(int connection) {
  try {
    catch_interruptions();
    Worker(connection).serve();
  } catch (const std::bad_alloc&) {
    _exit(out_of_memory);
  } catch (const std::exception& error) {
    const std::string text = fmt::format("capsoc: internal error: {}\n", error.what());
    _exit(write(STDERR_FILENO, text.data(), text.size()) < 0 ? 1 : 70);
  }
}

}  // namespace

Result<WorkerProcess> WorkerProcess::start(const std::function<void()>& close_others) {
  const auto no_process = [](int error) {
    return Error{
        fmt::format("a simulation cannot be started: {}; close another one", std::strerror(error))};
  };
  int pair[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0) return no_process(errno);
  WorkerProcess worker;
  worker.connection.reset(pair[0]);
  host::Descriptor theirs(pair[1]);
  void* const place =
      mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (place == MAP_FAILED) return no_process(errno);
  worker.shared = std::shared_ptr<Shared>(new (place) Shared,
                                          [](Shared* mapped) { munmap(mapped, sizeof *mapped); });
  const pid_t parent = getpid();
  worker.process = fork();
  if (worker.process < 0) return no_process(errno);
  if (worker.process == 0) {
    host::end_with_parent(parent, 1);
    host::leave_terminal();
    close_others();
    to_be_interrupted = worker.shared.get();
    close(pair[0]);
    work(theirs.release());
  }
  fcntl(pair[0], F_SETFL, O_NONBLOCK);
  return worker;
}

void WorkerProcess::interrupt(uint64_t call) const {
  shared->interrupted_call = call;
  kill(process, interrupt_signal);
}

}  // namespace capsoc::service
