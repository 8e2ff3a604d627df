#include "service/session_client.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "host/child_process.h"
#include "service/session.h"

namespace capsoc::service {

uint64_t SessionClient::send(const std::string& method, Json parameters, Frames frames) {
  const uint64_t number = next_++;
  write(bytes_of(number, method, std::move(parameters), std::move(frames)));
  return number;
}

std::vector<uint64_t> SessionClient::send_all(const Requests& requests) {
  std::vector<uint64_t> numbers;
  std::string bytes;
  for (const auto& [method, parameters] : requests) {
    numbers.push_back(next_);
    bytes += bytes_of(next_++, method, parameters, {});
  }
  write(bytes);
  return numbers;
}

std::string SessionClient::bytes_of(uint64_t number, const std::string& method, Json parameters,
                                    Frames frames) {
  Message message;
  message.body = {
      {"jsonrpc", "2.0"}, {"id", number}, {"method", method}, {"params", std::move(parameters)}};
  message.frames = std::move(frames);
  return to_bytes(message);
}

void SessionClient::write(const std::string& bytes) {
  if (!is_gone_ && !host::write_all(connection_.get(), bytes)) is_gone_ = true;
}

void SessionClient::take(Message message) {
  Json& body = message.body;
  const auto id = body.find("id");
  if (id == body.end() || !id->is_number_unsigned()) return;
  Answer& answer = answers_[id->get<uint64_t>()];
  if (const auto error = body.find("error"); error != body.end()) {
    answer = refuse(error->value("message", ""), static_cast<Code>(error->value("code", 1)));
    return;
  }
  answer.result = std::move(body["result"]);
  answer.frames = std::move(message.frames);
}

/// False: nothing came.
bool SessionClient::receive(std::chrono::milliseconds longest) {
  pollfd readable{connection_.get(), POLLIN, 0};
  if (poll(&readable, 1, static_cast<int>(longest.count())) <= 0) return false;
  char buffer[65536];
  const ssize_t count = read(connection_.get(), buffer, sizeof buffer);
  if (count < 0 && errno == EINTR) return false;
  if (count <= 0) {
    is_gone_ = true;
    return false;
  }
  reader_.feed({buffer, static_cast<std::size_t>(count)});
  while (auto incoming = reader_.next()) {
    if (incoming->message) take(std::move(*incoming->message));
    if (incoming->last) is_gone_ = true;
  }
  return true;
}

std::optional<Answer> SessionClient::wait(uint64_t number, std::chrono::milliseconds longest) {
  const auto end = std::chrono::steady_clock::now() + longest;
  for (;;) {
    if (const auto found = answers_.find(number); found != answers_.end()) {
      Answer answer = std::move(found->second);
      answers_.erase(found);
      return answer;
    }
    if (is_gone_) return refuse("the session has ended", Code::no_simulation);
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        end - std::chrono::steady_clock::now());
    if (!receive(std::max(left, std::chrono::milliseconds(0))) && left.count() <= 0)
      return std::nullopt;
  }
}

Answer SessionClient::call(const std::string& method, Json parameters, Frames frames) {
  constexpr std::chrono::milliseconds a_while{1000};
  const uint64_t number = send(method, std::move(parameters), std::move(frames));
  for (;;)
    if (auto answer = wait(number, a_while)) return std::move(*answer);
}

Result<ChildSession> ChildSession::start() {
  const auto failed = [] {
    return Error{fmt::format("a session cannot be started: {}", std::strerror(errno))};
  };
  int pair[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0) return failed();
  host::Descriptor ours(pair[0]);
  const host::Descriptor theirs(pair[1]);
  const pid_t parent = getpid();
  const pid_t process = fork();
  if (process < 0) return failed();
  if (process == 0) {
    host::end_with_parent(parent, 1);
    host::leave_terminal();
    dup2(theirs.get(), STDIN_FILENO);
    dup2(theirs.get(), STDOUT_FILENO);
    close(pair[0]);
    close(pair[1]);
    Session(Door()).serve();
    _exit(0);
  }
  return ChildSession(process, std::move(ours));
}

ChildSession::ChildSession(pid_t process, host::Descriptor connection)
    : process_(process), client_(std::make_unique<SessionClient>(std::move(connection))) {}

ChildSession::ChildSession(ChildSession&& other) noexcept
    : process_(std::exchange(other.process_, -1)), client_(std::move(other.client_)) {}

ChildSession::~ChildSession() {
  if (process_ < 0) return;
  client_.reset();
  int status = 0;
  while (waitpid(process_, &status, 0) < 0 && errno == EINTR) continue;
}

}  // namespace capsoc::service
