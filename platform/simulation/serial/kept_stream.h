// A stream whose other end is in this process.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "serial/character_backend.h"

namespace capsoc::serial {

/// Keeps what the guest says until it is taken, and has for it what was given.
class KeptStream {
 public:
  /// Bytes of the guest that nobody has taken; the oldest go.
  static constexpr std::size_t most_kept = std::size_t{2} << 20;

  void say(std::string_view bytes) {
    said_ += bytes;
    if (said_.size() <= most_kept) return;
    const std::size_t many = said_.size() - most_kept / 2;
    said_.erase(0, many);
    lost_ += many;
  }
  /// `lost`: bytes before it that were too many to be kept.
  std::string take(uint64_t& lost) {
    lost = std::exchange(lost_, 0);
    return std::exchange(said_, {});
  }
  const std::string& said() const { return said_; }

  void give(std::string_view bytes) { given_ += bytes; }
  /// A line, or what there is.
  std::string read() {
    const std::size_t end = given_.find('\n');
    const std::string line = given_.substr(0, end == std::string::npos ? end : end + 1);
    given_.erase(0, line.size());
    return line;
  }
  const std::string& given() const { return given_; }

 private:
  std::string said_, given_;
  uint64_t lost_ = 0;
};

/// The guest's end. The stream must outlive it.
class KeptBackend final : public CharacterBackend {
 public:
  explicit KeptBackend(KeptStream& stream) : stream_(stream) {}
  void write(std::string_view bytes) override { stream_.say(bytes); }
  std::string read() override { return stream_.read(); }

 private:
  KeptStream& stream_;
};

/// For a run that belongs to somebody who has other uses for the standard streams.
struct KeptStreams {
  KeptStream itm, console;

  std::array<std::pair<const char*, KeptStream*>, 2> all() {
    return {{{"itm", &itm}, {"console", &console}}};
  }
};

}  // namespace capsoc::serial
