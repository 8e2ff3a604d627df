#include "view/http_server.h"

#include <event2/buffer.h>
#include <event2/bufferevent.h>
#include <event2/event.h>
#include <event2/http.h>
#include <event2/keyvalq_struct.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <sys/random.h>
#include <sys/socket.h>

#include <array>
#include <atomic>
#include <csignal>
#include <list>
#include <optional>
#include <thread>
#include <utility>

#include "host/descriptor.h"
#include "host/loopback.h"
#include "view/page.h"

namespace capsoc::view {
namespace {

constexpr int seconds_unread = 10;      ///< then a connection that takes nothing is closed
constexpr int kernel_buffer = 131072;   ///< of a stream, bytes
constexpr timeval heartbeat{1, 0};      ///< finds streams whose page has gone, or reads again
constexpr timeval farewell{0, 200000};  ///< for the last frames

std::string random_token() {
  std::array<uint8_t, 16> random{};
  if (getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size())) return "";
  std::string token;
  for (const uint8_t byte : random) token += fmt::format("{:02x}", byte);
  return token;
}

/// Takes as long wherever they differ.
bool equal_in_constant_time(const std::string& given, const std::string& token) {
  unsigned difference = given.size() == token.size() ? 0 : 1;
  for (std::size_t i = 0; i < token.size(); ++i)
    difference |= static_cast<unsigned char>(i < given.size() ? given[i] : '\0') ^
                  static_cast<unsigned char>(token[i]);
  return difference == 0;
}

std::string header(evhttp_request* request, const char* name) {
  const char* value = evhttp_find_header(evhttp_request_get_input_headers(request), name);
  return value == nullptr ? "" : value;
}

std::string path_of(evhttp_request* request) {
  const evhttp_uri* uri = evhttp_request_get_evhttp_uri(request);
  const char* path = uri == nullptr ? nullptr : evhttp_uri_get_path(uri);
  return path == nullptr ? "" : path;
}

/// The token of the query, or of its header.
std::string token_of(evhttp_request* request) {
  if (evhttp_request_get_command(request) == EVHTTP_REQ_POST)
    return header(request, "X-Capsoc-Token");
  const evhttp_uri* uri = evhttp_request_get_evhttp_uri(request);
  const char* query = uri == nullptr ? nullptr : evhttp_uri_get_query(uri);
  evkeyvalq values{};
  if (query == nullptr || evhttp_parse_query_str(query, &values) != 0) return "";
  const char* value = evhttp_find_header(&values, "token");
  std::string token = value == nullptr ? "" : value;
  evhttp_clear_headers(&values);
  return token;
}

void add_header(evhttp_request* request, const char* name, const std::string& value) {
  evhttp_add_header(evhttp_request_get_output_headers(request), name, value.c_str());
}

void reply(evhttp_request* request, int code, const char* type, const std::string& text) {
  add_header(request, "Content-Type", type);
  add_header(request, "Cache-Control", "no-store");
  add_header(request, "X-Content-Type-Options", "nosniff");
  add_header(request, "Referrer-Policy", "no-referrer");
  add_header(request, "Cross-Origin-Resource-Policy", "same-origin");
  evbuffer* body = evbuffer_new();
  evbuffer_add(body, text.data(), text.size());
  evhttp_send_reply(request, code, nullptr, body);
  evbuffer_free(body);
}

void reply_sentence(evhttp_request* request, int code, const std::string& sentence) {
  reply(request, code, "application/json", Json({{"error", sentence}}).dump() + "\n");
}

std::string body_of(evhttp_request* request) {
  evbuffer* body = evhttp_request_get_input_buffer(request);
  std::string text(evbuffer_get_length(body), '\0');
  evbuffer_copyout(body, text.data(), text.size());
  return text;
}

/// Log lines of the library are no part of a run's output.
void drop_log(int, const char*) {}

}  // namespace

/// Everything of the server's thread.
class HttpServer::Loop {
 public:
  explicit Loop(Hub& hub) : hub_(hub) {}
  ~Loop();
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;

  std::optional<Error> open(uint16_t port);
  std::string url() const { return fmt::format("http://127.0.0.1:{}/?token={}", port_, token_); }

 private:
  /// A page that is sent frames.
  struct Stream {
    Loop* loop;
    evhttp_request* request;
    evhttp_connection* connection;
    bool lacks_frames = true;

    std::size_t unread() const {
      return evbuffer_get_length(
          bufferevent_get_output(evhttp_connection_get_bufferevent(connection)));
    }
  };

  std::optional<Error> begin(host::Listener listener);
  void run();
  void wake() const {
    const uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = write(wake_.get(), &one, sizeof one);
  }
  bool is_allowed(evhttp_request* request) const;
  void answer(evhttp_request* request);
  void command(evhttp_request* request);
  void open_stream(evhttp_request* request);
  void forget(const Stream* stream);
  void news();
  void send(Stream& stream, const Frame& frame);
  static void send(Stream& stream, const std::string& text);
  void beat();

  Hub& hub_;
  uint16_t port_ = 0;
  std::string token_;
  std::string page_ = page(), policy_ = page_policy();
  host::Descriptor wake_;
  event_base* base_ = nullptr;
  evhttp* http_ = nullptr;
  event *news_ = nullptr, *beat_ = nullptr;
  std::list<Stream> streams_;
  uint64_t last_frame_ = 0;
  std::atomic<bool> is_ending_{false};
  bool says_farewell_ = false;
  std::thread thread_;
};

std::optional<Error> HttpServer::Loop::open(uint16_t port) {
  auto listener = host::listen_on_loopback(port, "--view");
  if (!listener) return Error{listener.error()};
  port_ = listener.value().port;
  token_ = random_token();
  wake_.reset(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC));
  if (token_.empty() || !wake_.valid())
    return Error{"--view: the system has no random numbers or no descriptors left"};
  return begin(std::move(listener.value()));
}

std::optional<Error> HttpServer::Loop::begin(host::Listener listener) {
  event_set_log_callback(drop_log);
  fcntl(listener.socket.get(), F_SETFL, O_NONBLOCK);
  base_ = event_base_new();
  http_ = base_ == nullptr ? nullptr : evhttp_new(base_);
  if (http_ == nullptr) return Error{"--view: the HTTP server cannot be started"};
  evhttp_set_allowed_methods(http_, EVHTTP_REQ_GET | EVHTTP_REQ_POST);
  evhttp_set_max_headers_size(http_, 8192);
  evhttp_set_max_body_size(http_, largest_command);
  evhttp_set_timeout(http_, seconds_unread);
  evhttp_set_gencb(
      http_, [](evhttp_request* request, void* loop) { static_cast<Loop*>(loop)->answer(request); },
      this);
  if (evhttp_accept_socket(http_, listener.socket.get()) != 0)
    return Error{"--view: the HTTP server cannot listen"};
  listener.socket.release();
  news_ = event_new(
      base_, wake_.get(), EV_READ | EV_PERSIST,
      [](evutil_socket_t, short, void* loop) { static_cast<Loop*>(loop)->news(); }, this);
  beat_ = event_new(
      base_, -1, EV_PERSIST,
      [](evutil_socket_t, short, void* loop) { static_cast<Loop*>(loop)->beat(); }, this);
  event_add(news_, nullptr);
  event_add(beat_, &heartbeat);
  hub_.on_publish([this] { wake(); });
  thread_ = std::thread([this] { run(); });
  return std::nullopt;
}

void HttpServer::Loop::run() {
  // Signals are the run's.
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
  event_base_dispatch(base_);
}

HttpServer::Loop::~Loop() {
  hub_.on_publish(nullptr);
  if (thread_.joinable()) {
    is_ending_ = true;
    wake();
    thread_.join();
  }
  if (news_ != nullptr) event_free(news_);
  if (beat_ != nullptr) event_free(beat_);
  if (http_ != nullptr) evhttp_free(http_);
  if (base_ != nullptr) event_base_free(base_);
}

bool HttpServer::Loop::is_allowed(evhttp_request* request) const {
  const std::string host = header(request, "Host"), origin = header(request, "Origin");
  const bool is_ours =
      host == fmt::format("127.0.0.1:{}", port_) || host == fmt::format("localhost:{}", port_);
  const bool is_same = origin.empty() || origin == "http://" + host;
  return is_ours && is_same && equal_in_constant_time(token_of(request), token_);
}

void HttpServer::Loop::answer(evhttp_request* request) {
  if (!is_allowed(request))
    return reply_sentence(request, 403, "open the address that capsoc printed");
  const std::string path = path_of(request);
  const bool is_post = evhttp_request_get_command(request) == EVHTTP_REQ_POST;
  if (is_post && path == "/do") return command(request);
  if (!is_post && path == "/events") return open_stream(request);
  if (is_post || path != "/") return reply_sentence(request, 404, "there is nothing here");
  add_header(request, "Content-Security-Policy", policy_);
  reply(request, 200, "text/html; charset=utf-8", page_);
}

void HttpServer::Loop::command(evhttp_request* request) {
  Json body = Json::parse(body_of(request), nullptr, false);
  const auto what = body.is_object() ? body.find("do") : body.end();
  if (!body.is_object() || what == body.end() || !what->is_string())
    return reply_sentence(request, 400, "a command is a JSON object with the text \"do\"");
  const auto number = hub_.add(std::move(body));
  if (!number) return reply_sentence(request, 503, "too many commands wait");
  reply(request, 202, "application/json", Json({{"command", *number}}).dump() + "\n");
}

void HttpServer::Loop::open_stream(evhttp_request* request) {
  if (streams_.size() >= most_streams)
    return reply_sentence(request, 503, "too many pages are open");
  evhttp_connection* connection = evhttp_request_get_connection(request);
  streams_.push_back({this, request, connection});
  evhttp_connection_set_closecb(
      connection,
      [](evhttp_connection*, void* stream) {
        const auto* closed = static_cast<Stream*>(stream);
        closed->loop->forget(closed);
      },
      &streams_.back());
  // The kernel's buffer would grow to megabytes of old frames.
  const evutil_socket_t socket = bufferevent_getfd(evhttp_connection_get_bufferevent(connection));
  setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &kernel_buffer, sizeof kernel_buffer);
  add_header(request, "Content-Type", "text/event-stream");
  add_header(request, "Cache-Control", "no-store");
  add_header(request, "X-Content-Type-Options", "nosniff");
  evhttp_send_reply_start(request, 200, nullptr);
  send(streams_.back(), "retry: 1000\n\n");
  hub_.ask_for_full();
  hub_.set_viewers(streams_.size());
}

void HttpServer::Loop::forget(const Stream* stream) {
  streams_.remove_if([stream](const Stream& each) { return &each == stream; });
  hub_.set_viewers(streams_.size());
}

void HttpServer::Loop::news() {
  uint64_t count = 0;
  [[maybe_unused]] const ssize_t taken = read(wake_.get(), &count, sizeof count);
  for (const Frame& frame : hub_.take_frames()) {
    const bool is_gap = std::exchange(last_frame_, frame.number) + 1 != frame.number;
    // Sending may close a connection, which takes its stream from the list.
    for (auto next = streams_.begin(); next != streams_.end();) {
      Stream& stream = *next++;
      stream.lacks_frames = stream.lacks_frames || is_gap || frame.begins;
      send(stream, frame);
    }
  }
  if (is_ending_ && !std::exchange(says_farewell_, true)) event_base_loopexit(base_, &farewell);
}

/// A page that does not read loses frames, and gets the complete state when it reads again.
void HttpServer::Loop::send(Stream& stream, const Frame& frame) {
  if (stream.unread() > most_unread)
    stream.lacks_frames = true;
  else if (!stream.lacks_frames)
    send(stream, "event: update\ndata: " + *frame.update + "\n\n");
  else if (frame.full == nullptr)
    hub_.ask_for_full();
  else {
    stream.lacks_frames = false;
    send(stream, "event: full\ndata: " + *frame.full + "\n\n");
  }
}

void HttpServer::Loop::send(Stream& stream, const std::string& text) {
  evbuffer* chunk = evbuffer_new();
  evbuffer_add(chunk, text.data(), text.size());
  evhttp_send_reply_chunk(stream.request, chunk);
  evbuffer_free(chunk);
}

void HttpServer::Loop::beat() {
  for (auto next = streams_.begin(); next != streams_.end();) {
    Stream& stream = *next++;
    if (stream.unread() > 0) continue;
    if (stream.lacks_frames) hub_.ask_for_full();  // of a run that stands no frame would come
    send(stream, ":\n\n");
  }
}

HttpServer::HttpServer(std::unique_ptr<Loop> loop) : loop_(std::move(loop)) {}
HttpServer::~HttpServer() = default;

Result<std::unique_ptr<HttpServer>> HttpServer::start(uint16_t port, Hub& hub) {
  auto loop = std::make_unique<Loop>(hub);
  if (auto error = loop->open(port)) return *error;
  return std::unique_ptr<HttpServer>(new HttpServer(std::move(loop)));
}

std::string HttpServer::url() const {
  return loop_->url();
}

}  // namespace capsoc::view
