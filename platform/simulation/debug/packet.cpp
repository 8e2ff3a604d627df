#include "debug/packet.h"

namespace capsoc::debug {
namespace {

constexpr char escape = '}', run_length = '*', interrupt_byte = 0x03;
constexpr char escape_mask = 0x20;

int digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

char hex_digit(unsigned value) {
  return "0123456789abcdef"[value & 15];
}

}  // namespace

uint8_t checksum(std::string_view bytes) {
  uint8_t sum = 0;
  for (const char c : bytes) sum = static_cast<uint8_t>(sum + static_cast<uint8_t>(c));
  return sum;
}

std::string frame(std::string_view payload) {
  std::string escaped;
  escaped.reserve(payload.size() + 4);
  for (const char c : payload) {
    if (c == '$' || c == '#' || c == escape || c == run_length) {
      escaped += escape;
      escaped += static_cast<char>(c ^ escape_mask);
    } else {
      escaped += c;
    }
  }
  const uint8_t sum = checksum(escaped);
  return "$" + escaped + "#" + hex_digit(sum >> 4u) + hex_digit(sum);
}

std::optional<std::string> unescape(std::string_view payload) {
  constexpr int count_bias = 29;  // `0* ` stands for four zeros: ' ' is 32, three more of them
  std::string bytes;
  for (std::size_t i = 0; i < payload.size(); ++i) {
    const bool last = i + 1 == payload.size();
    if (payload[i] == escape) {
      if (last) return std::nullopt;
      bytes += static_cast<char>(payload[++i] ^ escape_mask);
    } else if (payload[i] == run_length) {
      if (last || bytes.empty()) return std::nullopt;
      const int more = static_cast<uint8_t>(payload[++i]) - count_bias;
      if (more < 3 || more > 97) return std::nullopt;
      bytes.append(static_cast<std::size_t>(more), bytes.back());
    } else {
      bytes += payload[i];
    }
    if (bytes.size() > largest_packet) return std::nullopt;
  }
  return bytes;
}

std::string to_hex(std::string_view bytes) {
  std::string text;
  text.reserve(2 * bytes.size());
  for (const char c : bytes) {
    text += hex_digit(static_cast<uint8_t>(c) >> 4u);
    text += hex_digit(static_cast<uint8_t>(c));
  }
  return text;
}

std::optional<std::string> from_hex(std::string_view digits) {
  if (digits.size() % 2 != 0) return std::nullopt;
  std::string bytes;
  bytes.reserve(digits.size() / 2);
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    const int high = digit(digits[i]), low = digit(digits[i + 1]);
    if (high < 0 || low < 0) return std::nullopt;
    bytes += static_cast<char>(high * 16 + low);
  }
  return bytes;
}

std::optional<uint32_t> take_number(std::string_view& text) {
  uint32_t value = 0;
  std::size_t used = 0;
  for (; used < text.size() && digit(text[used]) >= 0; ++used) {
    if (used == 8) return std::nullopt;
    value = value << 4u | static_cast<uint32_t>(digit(text[used]));
  }
  if (used == 0) return std::nullopt;
  text.remove_prefix(used);
  return value;
}

bool take(std::string_view& text, std::string_view prefix) {
  if (text.substr(0, prefix.size()) != prefix) return false;
  text.remove_prefix(prefix.size());
  return true;
}

Arrival PacketReader::finish(char second_digit) {
  state_ = State::idle;
  const int high = digit(first_digit_), low = digit(second_digit);
  const bool right = high >= 0 && low >= 0 && high * 16 + low == checksum(raw_);
  if (too_long_ || (checked_ && !right)) return {Arrival::Kind::damaged};
  auto payload = unescape(raw_);
  if (!payload) return {Arrival::Kind::damaged};
  return {Arrival::Kind::packet, std::move(*payload)};
}

std::vector<Arrival> PacketReader::feed(std::string_view bytes) {
  std::vector<Arrival> arrivals;
  for (const char c : bytes) {
    switch (state_) {
      case State::idle:
        if (c == interrupt_byte) arrivals.push_back({Arrival::Kind::interrupt});
        if (c == '+') arrivals.push_back({Arrival::Kind::ack});
        if (c == '-') arrivals.push_back({Arrival::Kind::nak});
        if (c != '$') break;
        raw_.clear();
        too_long_ = false;
        state_ = State::payload;
        break;
      case State::payload:
        if (c == '#') {
          state_ = State::first_digit;
        } else if (c == '$') {  // the end of the last one was lost
          arrivals.push_back({Arrival::Kind::damaged});
          raw_.clear();
          too_long_ = false;
        } else if (raw_.size() == largest_packet) {
          too_long_ = true;
        } else {
          raw_ += c;
        }
        break;
      case State::first_digit:
        first_digit_ = c;
        state_ = State::second_digit;
        break;
      case State::second_digit:
        arrivals.push_back(finish(c));
        break;
    }
  }
  return arrivals;
}

}  // namespace capsoc::debug
