// A client of a session, in its own program.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "host/descriptor.h"
#include "service/message.h"
#include "service/verb.h"

namespace capsoc::service {

/// Asks one question after the other over a connection that is not shared.
class SessionClient {
 public:
  explicit SessionClient(host::Descriptor connection) : connection_(std::move(connection)) {}

  /// Sends a request; its number.
  uint64_t send(const std::string& method, Json parameters, Frames frames = {});
  /// Sends requests together; their numbers.
  using Requests = std::vector<std::pair<std::string, Json>>;
  std::vector<uint64_t> send_all(const Requests& requests);
  /// The answer to a request, if it comes within so long. A session that has gone answers with a
  /// refusal (Code::no_simulation).
  std::optional<Answer> wait(uint64_t number, std::chrono::milliseconds longest);
  /// Sends, and waits as long as it takes.
  Answer call(const std::string& method, Json parameters, Frames frames = {});

 private:
  static std::string bytes_of(uint64_t number, const std::string& method, Json parameters,
                              Frames frames);
  void write(const std::string& bytes);
  bool receive(std::chrono::milliseconds longest);
  void take(Message message);

  host::Descriptor connection_;
  MessageReader reader_;
  std::map<uint64_t, Answer> answers_;
  uint64_t next_ = 1;
  bool is_gone_ = false;
};

/// A session in its own process, with this one client. Before this process has a thread.
class ChildSession {
 public:
  static Result<ChildSession> start();
  ChildSession(ChildSession&& other) noexcept;
  ChildSession& operator=(ChildSession&&) = delete;
  /// The session ends, and this waits for it.
  ~ChildSession();

  SessionClient& client() { return *client_; }

 private:
  ChildSession(pid_t process, host::Descriptor connection);
  pid_t process_;
  std::unique_ptr<SessionClient> client_;
};

}  // namespace capsoc::service
