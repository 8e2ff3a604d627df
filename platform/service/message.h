// Messages of the session protocol (docs/reference/protocol.md): JSON-RPC 2.0, one line each, with
// arrays as binary frames after the line.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace capsoc::service {

using Json = nlohmann::ordered_json;
using Frames = std::vector<std::string>;

/// The codes of errors: JSON-RPC's own, and three of the protocol.
enum class Code : int {
  parse_error = -32700,
  invalid_request = -32600,
  unknown_method = -32601,
  wrong_parameter = -32602,
  refused = 1,        ///< a wrong setting, a file, a place that nothing answers
  no_simulation = 2,  ///< there is none of that number, or its process has ended
  over = 3,           ///< the simulation is over and cannot continue
};

/// One message of either direction. `body` is an object.
struct Message {
  Json body;
  Frames frames;
};

/// As it goes over a connection. Bytes that are no UTF-8 become U+FFFD.
std::string to_bytes(const Message& message);

/// Takes the bytes of a connection apart. Damage is answered and passed over; only a message that
/// is too large ends the connection, since nothing says where the next one begins.
class MessageReader {
 public:
  static constexpr std::size_t longest_line = std::size_t{16} << 20;
  static constexpr std::size_t most_frames = 4096, most_frame_bytes = std::size_t{1} << 30;
  static constexpr int deepest = 64;  ///< of nested arrays and objects

  struct Incoming {
    std::optional<Message> message;  ///< nothing: `damage` says why
    Code code = Code::parse_error;   ///< of the damage
    std::string damage;
    bool last = false;  ///< nothing can be read after it
  };

  void feed(std::string_view bytes) { buffer_.append(bytes); }
  /// The next message that is there as a whole.
  std::optional<Incoming> next();
  /// Nothing is left of what was fed, not even a part of a message.
  bool is_empty() const { return begin_ == buffer_.size() && !waiting_; }

 private:
  void tidy();
  bool take_line(std::string& line);
  Incoming parse(const std::string& line);
  Incoming damaged(Code code, std::string sentence, bool last = false);
  std::optional<Incoming> plan_frames(Json& body);

  std::string buffer_;
  std::size_t begin_ = 0, searched_ = 0;  // of what is not taken yet
  std::optional<Message> waiting_;        // for its frames
  std::vector<std::size_t> sizes_;        // of all of them
  std::size_t total_ = 0;                 // bytes of all of them
};

/// An error object.
Json error_of(Code code, const std::string& sentence);

}  // namespace capsoc::service
