#include "service/session.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>

#include "base/nearest.h"
#include "base/printable.h"
#include "host/end_signals.h"
#include "service/board_verbs.h"
#include "service/session_parts.h"

namespace capsoc::service {
namespace {

constexpr int longest_wait_ms = 1000, closing_wait_ms = 20;
constexpr std::size_t most_clients = 64;
constexpr std::size_t piece = 65536;

bool is_pipe_or_socket(int descriptor) {
  struct stat about {};
  return fstat(descriptor, &about) == 0 && (S_ISFIFO(about.st_mode) || S_ISSOCK(about.st_mode));
}

void set_nonblocking(int descriptor) {
  fcntl(descriptor, F_SETFL, fcntl(descriptor, F_GETFL) | O_NONBLOCK);
}

/// Null in a message that wants no answer.
bool is_identifier(const Json& id) {
  return id.is_string() || id.is_number() || id.is_null();
}

}  // namespace

Session::Session(Door door) : door_(std::move(door)) {
  if (door_.listener.valid()) return;
  auto client = std::make_unique<Client>();
  client->number = next_client_++;
  client->is_standard = client->is_authenticated = true;
  client->input.reset(STDIN_FILENO);
  client->output.reset(STDOUT_FILENO);
  if (is_pipe_or_socket(STDOUT_FILENO)) set_nonblocking(STDOUT_FILENO);
  clients_[client->number] = std::move(client);
}

Session::~Session() {
  for (auto& [number, client] : clients_)
    if (client->is_standard) {
      client->input.release();
      client->output.release();
    }
}

void Session::serve() {
  while (!is_ending_ && host::noted_signal() == 0) {
    wait();
    reap();
    tidy();
    if (!door_.listener.valid() && clients_.empty()) break;
  }
  for (auto& [number, simulation] : simulations_) {
    end_worker(*simulation);
    ending_.push_back(std::move(simulation));
  }
  simulations_.clear();
  while (!ending_.empty()) {
    poll(nullptr, 0, closing_wait_ms);
    reap();
  }
  for (auto& [number, client] : clients_) client->outbox.write_to(client->write_descriptor());
}

/// Most of what is to be sent goes out at once, answers to requests that came together in one
/// piece.
void Session::send() {
  for (auto& [number, client] : clients_)
    if (!client->outbox.empty() && !client->outbox.write_to(client->write_descriptor()))
      client->is_gone = true;
  for (auto& [number, simulation] : simulations_)
    if (!simulation->outbox.empty())
      simulation->outbox.write_to(simulation->worker.connection.get());
}

/// Waits until a client or worker has sent data or can take some, and serves all that are ready.
void Session::wait() {
  send();
  std::vector<pollfd> all;
  std::vector<std::function<void(short)>> then;
  const auto watch = [&](int descriptor, int wanted, std::function<void(short)> what) {
    if (wanted == 0) return;
    // poll() reports a pipe without a reader even if no event is asked for.
    const auto events = static_cast<short>(wanted == POLLERR ? 0 : wanted);
    all.push_back({descriptor, events, 0});
    then.push_back(std::move(what));
  };
  if (door_.listener.valid() && clients_.size() < most_clients)
    watch(door_.listener.get(), POLLIN, [this](short) { accept(); });
  for (auto& [number, each] : clients_) {
    Client* const client = each.get();
    const bool reads = !client->is_finished && !client->outbox.is_full();
    watch(client->input.get(), reads ? POLLIN : 0, [this, client](short) { read_client(*client); });
    const int writes = client->outbox.empty() ? POLLERR : POLLOUT;
    watch(client->write_descriptor(), writes, [client](short seen) {
      const bool is_read = (seen & POLLERR) == 0;
      if (!is_read || !client->outbox.write_to(client->write_descriptor())) client->is_gone = true;
    });
  }
  for (auto& [number, each] : simulations_) {
    Simulation* const simulation = each.get();
    const auto client = clients_.find(simulation->client);
    const bool reads = client == clients_.end() || !client->second->outbox.is_full();
    const int events = (reads ? POLLIN : 0) | (simulation->outbox.empty() ? 0 : POLLOUT);
    watch(simulation->worker.connection.get(), events, [this, simulation](short seen) {
      if ((seen & POLLOUT) != 0) simulation->outbox.write_to(simulation->worker.connection.get());
      if ((seen & (POLLIN | POLLHUP | POLLERR)) != 0) read_worker(*simulation);
    });
  }
  const int longest = ending_.empty() ? longest_wait_ms : closing_wait_ms;
  if (poll(all.data(), all.size(), longest) <= 0) return;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].revents != 0) then[i](all[i].revents);
}

void Session::accept() {
  const int descriptor = accept4(door_.listener.get(), nullptr, nullptr, SOCK_CLOEXEC);
  if (descriptor < 0) return;
  host::Descriptor socket(descriptor);
  ucred peer{};
  socklen_t size = sizeof peer;
  if (door_.checks_user &&
      (getsockopt(descriptor, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0 || peer.uid != geteuid()))
    return;
  set_nonblocking(descriptor);
  auto client = std::make_unique<Client>();
  client->number = next_client_++;
  client->input = std::move(socket);
  client->is_authenticated = door_.token.empty();
  clients_[client->number] = std::move(client);
}

void Session::read_client(Client& client) {
  char buffer[piece];
  const ssize_t count = read(client.input.get(), buffer, sizeof buffer);
  if (count < 0 && (errno == EINTR || errno == EAGAIN)) return;
  if (count <= 0) {
    client.is_finished = true;
    if (count < 0 || !client.is_standard) client.is_gone = true;
    return;
  }
  client.reader.feed({buffer, static_cast<std::size_t>(count)});
  const uint64_t number = client.number;
  while (!client.is_gone && !client.is_finished && !is_ending_) {
    auto incoming = client.reader.next();
    if (!incoming) break;
    if (incoming->message) {
      take(client, std::move(*incoming->message));
      continue;
    }
    answer_client(number, nullptr, refuse(incoming->damage, incoming->code));
    if (incoming->last) client.is_finished = true;
  }
}

void Session::take(Client& client, Message message) {
  Json& body = message.body;
  const auto id = body.find("id"), method = body.find("method");
  const bool right = method != body.end() && method->is_string() &&
                     (id == body.end() || is_identifier(*id)) &&
                     body.value("jsonrpc", Json("2.0")) == Json("2.0");
  if (!right)
    return answer_client(client.number, nullptr,
                         refuse(R"(write {"jsonrpc": "2.0", "id": 1, "method": "...", )"
                                R"("params": {...}})",
                                Code::invalid_request));
  // A request without an id gets no answer (JSON-RPC notification).
  Request request{client.number, id == body.end() ? Json(Json::value_t::discarded) : *id,
                  method->get<std::string>(), Json::object(), std::move(message.frames)};
  if (const auto parameters = body.find("params"); parameters != body.end())
    request.parameters = std::move(*parameters);
  if (!request.parameters.is_object())
    return answer(request, refuse("params: give an object with the parameters' names",
                                  Code::wrong_parameter));
  if (!client.is_authenticated && request.method != "session.authenticate") {
    answer(request, refuse("show the token first: session.authenticate", Code::refused));
    client.is_finished = true;
    return;
  }
  perform(request);
}

void Session::perform(Request& request) {
  for (const SessionVerb& verb : verbs()) {
    if (verb.about.method != request.method) continue;
    const Call call(verb.about, request.parameters, request.frames);
    if (std::string complaint = call.complaint(); !complaint.empty())
      return answer(request, refuse(std::move(complaint), Code::wrong_parameter));
    if (verb.of_simulation && verb.perform != &Session::close &&
        verb.perform != &Session::interrupt && waits(request))
      return;
    return (this->*verb.perform)(request);
  }
  if (board_verb(request.method) != nullptr) return waits(request) ? void() : forward(request);
  answer(request, no_such_method(request.method));
}

/// A request to a simulation that is being replaced waits for what takes its place.
bool Session::waits(Request& request) {
  const auto number = request.parameters.find("simulation");
  if (number == request.parameters.end() || !number->is_number_unsigned()) return false;
  const auto found = simulations_.find(number->get<uint64_t>());
  if (found == simulations_.end() || !found->second->is_replaced) return false;
  ++clients_.at(request.client)->calls;
  found->second->waiting.push_back(std::move(request));
  return true;
}

Answer Session::no_such_method(const std::string& method) {
  std::vector<std::string> names;
  for (const SessionVerb& verb : verbs()) names.push_back(verb.about.method);
  for (const BoardVerb& verb : board_verbs()) names.push_back(verb.about.method);
  const std::string asked = printable(method, 80);
  return refuse(
      fmt::format("there is no method '{}'; did you mean {}?", asked, nearest_names(asked, names)),
      Code::unknown_method);
}

void Session::answer(const Request& request, Answer answer) {
  if (!request.id.is_discarded()) answer_client(request.client, request.id, std::move(answer));
}

void Session::answer_client(uint64_t number, const Json& id, Answer answer) {
  const auto client = clients_.find(number);
  if (client == clients_.end() || client->second->is_gone) return;
  client->second->outbox.add(to_client(id, std::move(answer)));
}

void Session::read_worker(Simulation& simulation) {
  char buffer[piece];
  const ssize_t count = read(simulation.worker.connection.get(), buffer, sizeof buffer);
  if (count < 0 && (errno == EINTR || errno == EAGAIN)) return;
  if (count <= 0) {
    simulation.worker.connection.reset();
    return;
  }
  simulation.reader.feed({buffer, static_cast<std::size_t>(count)});
  while (auto incoming = simulation.reader.next()) {
    if (incoming->message) {
      take_answer(simulation, std::move(*incoming->message));
      continue;
    }
    // It has gone mad; that is no reason to do so, too.
    kill(simulation.worker.process, SIGKILL);
    return;
  }
}

void Session::take_answer(Simulation& simulation, Message message) {
  if (simulation.pending.empty()) return;
  const Take take = std::move(simulation.pending.front().take);
  simulation.pending.pop_front();
  Answer answer;
  const auto error = message.body.find("error");
  const auto result = message.body.find("result");
  if (error != message.body.end())
    answer = refuse(error->at("message").get<std::string>(),
                    static_cast<Code>(error->at("code").get<int>()));
  else if (result != message.body.end())
    answer.result = std::move(*result);
  answer.frames = std::move(message.frames);
  take(std::move(answer));
}

void Session::client_is_gone(Client& client) {
  std::vector<uint64_t> numbers;
  for (const auto& [number, simulation] : simulations_)
    if (simulation->client == client.number) numbers.push_back(number);
  // What another client has asked of it is answered.
  for (const uint64_t number : numbers)
    if (simulations_.count(number) > 0) end_simulation(number, "was closed: its client has gone");
}

/// Clients that have gone take their simulations along.
void Session::tidy() {
  for (auto at = clients_.begin(); at != clients_.end();) {
    Client& client = *at->second;
    const bool is_done = client.is_finished && client.calls == 0 && client.outbox.empty();
    if (!client.is_gone && !is_done) {
      ++at;
      continue;
    }
    client_is_gone(client);
    if (client.is_standard) {
      client.input.release();
      client.output.release();
    }
    at = clients_.erase(at);
  }
}

}  // namespace capsoc::service
