#include "service/message.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace capsoc::service {
namespace {

constexpr std::size_t worth_moving = std::size_t{1} << 16;  // bytes taken from the buffer's front
constexpr std::size_t most_reserved = std::size_t{64} << 20;

/// How deep arrays and objects are nested.
int depth_of(const std::string& line) {
  int depth = 0, greatest = 0;
  bool is_text = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char each = line[i];
    if (each == '"')
      is_text = !is_text;
    else if (is_text)
      i += each == '\\' ? 1 : 0;
    else if (each == '[' || each == '{')
      greatest = std::max(greatest, ++depth);
    else if (each == ']' || each == '}')
      --depth;
  }
  return greatest;
}

}  // namespace

std::string to_bytes(const Message& message) {
  std::string bytes;
  if (message.frames.empty()) {
    bytes = message.body.dump(-1, ' ', false, Json::error_handler_t::replace);
  } else {
    Json body = message.body;
    Json& sizes = body["frames"] = Json::array();
    for (const std::string& frame : message.frames) sizes.push_back(frame.size());
    bytes = body.dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  bytes += '\n';
  std::size_t size = bytes.size();
  for (const std::string& frame : message.frames) size += frame.size();
  bytes.reserve(size);
  for (const std::string& frame : message.frames) bytes += frame;
  return bytes;
}

Json error_of(Code code, const std::string& sentence) {
  return {{"code", static_cast<int>(code)}, {"message", sentence}};
}

/// The next line, without its end.
bool MessageReader::take_line(std::string& line) {
  const std::size_t end = buffer_.find('\n', std::max(begin_, searched_));
  searched_ = buffer_.size();
  if (end == std::string::npos) return false;
  line.assign(buffer_, begin_, end - begin_);
  begin_ = searched_ = end + 1;
  tidy();
  return true;
}

/// Moves what is left to the front, seldom enough that a long buffer takes time in proportion.
void MessageReader::tidy() {
  if (begin_ < buffer_.size() && (begin_ < worth_moving || begin_ < buffer_.size() / 2)) return;
  buffer_.erase(0, begin_);
  begin_ = searched_ = 0;
}

MessageReader::Incoming MessageReader::damaged(Code code, std::string sentence, bool last) {
  return {std::nullopt, code, std::move(sentence), last};
}

std::optional<MessageReader::Incoming> MessageReader::next() {
  if (!waiting_) {
    std::string line;
    do {
      if (!take_line(line)) {
        if (buffer_.size() - begin_ <= longest_line) return std::nullopt;
        return damaged(
            Code::parse_error,
            fmt::format("a line is longer than {} MiB; send arrays as frames", longest_line >> 20U),
            true);
      }
    } while (line.empty() || line == "\r");
    if (line.size() > longest_line)
      return damaged(Code::parse_error, "the line is too long; send arrays as frames");
    Incoming incoming = parse(line);
    if (!incoming.message) return incoming;
    if (auto damage = plan_frames(incoming.message->body)) return damage;
    if (sizes_.empty()) return incoming;
    waiting_ = std::move(incoming.message);
  }
  if (buffer_.size() - begin_ < total_) return std::nullopt;
  Incoming incoming;
  incoming.message = std::exchange(waiting_, std::nullopt);
  for (const std::size_t size : std::exchange(sizes_, {})) {
    incoming.message->frames.emplace_back(buffer_, begin_, size);
    begin_ += size;
  }
  searched_ = begin_;
  tidy();
  return incoming;
}

MessageReader::Incoming MessageReader::parse(const std::string& line) {
  if (depth_of(line) > deepest)
    return damaged(Code::parse_error, fmt::format("nested deeper than {} levels", deepest));
  Json body = Json::parse(line, nullptr, false);
  if (body.is_discarded())
    return damaged(Code::parse_error, "the line is no JSON; write one object a line");
  if (!body.is_object())
    return damaged(Code::invalid_request, "the line is no object; write one request a line");
  Incoming incoming;
  incoming.message = Message{std::move(body), {}};
  return incoming;
}

/// Takes "frames" out of the object. What it says wrongly ends the connection.
std::optional<MessageReader::Incoming> MessageReader::plan_frames(Json& body) {
  total_ = 0;
  const auto found = body.find("frames");
  if (found == body.end()) return std::nullopt;
  const Json list = std::move(*found);
  body.erase("frames");
  const auto refuse = [this](const char* why) {
    sizes_.clear();
    return damaged(Code::parse_error,
                   fmt::format("frames: {}; write the byte counts of what follows", why), true);
  };
  if (!list.is_array() || list.size() > most_frames) return refuse("no list, or too long a one");
  for (const Json& size : list) {
    if (!size.is_number_unsigned()) return refuse("one is no count");
    const auto bytes = size.get<uint64_t>();
    if (bytes > most_frame_bytes - total_) return refuse("more than 1 GiB in all");
    sizes_.push_back(static_cast<std::size_t>(bytes));
    total_ += static_cast<std::size_t>(bytes);
  }
  // As much as is promised may never come: no more than a growing buffer would have taken.
  buffer_.reserve(std::min(begin_ + total_, most_reserved));
  return std::nullopt;
}

}  // namespace capsoc::service
