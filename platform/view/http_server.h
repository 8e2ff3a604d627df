// The pages' HTTP server, on 127.0.0.1 alone, in its own thread.
//
//   GET /?token=T         the page
//   GET /events?token=T   frames as server-sent events: "full" and "update"
//   POST /do              a command as JSON, with the header X-Capsoc-Token; {"command": its
//   number}
//
// Whatever lacks the token, or names another host or origin than this server's, gets 403 and
// reaches nothing else.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "base/result.h"
#include "view/hub.h"

namespace capsoc::view {

class HttpServer {
 public:
  static constexpr std::size_t most_streams = 32;
  static constexpr std::size_t largest_command = 65536;
  /// Bytes on their way to a page, beyond which it loses frames until it has read them.
  static constexpr std::size_t most_unread = std::size_t{256} << 10;

  /// `port`: 0 takes a free one. `hub` outlives the server. An Error names the option --view.
  static Result<std::unique_ptr<HttpServer>> start(uint16_t port, Hub& hub);
  /// Sends what was published, as far as it is read at once, and closes all connections.
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// With the token.
  std::string url() const;

 private:
  class Loop;
  explicit HttpServer(std::unique_ptr<Loop> loop);
  std::unique_ptr<Loop> loop_;
};

}  // namespace capsoc::view
