// The packet layer of GDB's remote serial protocol ("Debugging with GDB", appendix E): framing,
// checksum, escapes, acknowledgements. Nothing here knows what a packet says.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace capsoc::debug {

/// Longest payload that is taken, in bytes as sent, and what PacketSize announces.
constexpr std::size_t largest_packet = 0x4000;

/// Sum of the bytes modulo 256.
uint8_t checksum(std::string_view bytes);
/// `$payload#xx`; the payload's bytes are escaped where the protocol needs it.
std::string frame(std::string_view payload);
/// The bytes after the escapes `}` and the run lengths `*`; nothing if they are malformed or would
/// be longer than largest_packet.
std::optional<std::string> unescape(std::string_view payload);

std::string to_hex(std::string_view bytes);
/// Nothing for an odd number of digits or anything else than digits.
std::optional<std::string> from_hex(std::string_view digits);
/// A number of 1 to 8 hexadecimal digits at the start of `text`, which loses them.
std::optional<uint32_t> take_number(std::string_view& text);
/// Whether `text` starts with the prefix, which it loses then.
bool take(std::string_view& text, std::string_view prefix);

/// What arrived on the line.
struct Arrival {
  enum class Kind {
    packet,     ///< with `payload`, unescaped
    damaged,    ///< a packet with a wrong checksum, bad escapes or too many bytes
    interrupt,  ///< the byte 0x03 outside a packet
    ack,
    nak
  };
  Kind kind;
  std::string payload = {};
};

/// Takes a stream apart, in pieces of any size. Bytes between packets that mean nothing are passed
/// over.
class PacketReader {
 public:
  std::vector<Arrival> feed(std::string_view bytes);
  /// In no-ack mode checksums are not looked at.
  void ignore_checksums() { checked_ = false; }

 private:
  enum class State { idle, payload, first_digit, second_digit };
  Arrival finish(char second_digit);

  State state_ = State::idle;
  bool checked_ = true, too_long_ = false;
  std::string raw_;
  char first_digit_ = 0;
};

}  // namespace capsoc::debug
