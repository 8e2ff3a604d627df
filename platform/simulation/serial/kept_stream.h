// A character stream whose host end is in this process.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "serial/character_backend.h"

namespace capsoc::serial {

/// Keeps the guest's output until it is taken, and has input for the guest.
class KeptStream {
 public:
  /// Most bytes of output that are kept; beyond that the oldest are dropped.
  static constexpr std::size_t most_kept = std::size_t{2} << 20;

  void say(std::string_view bytes) {
    sent_ += bytes.size();
    if (sent_ <= told_) return;
    const uint64_t fresh = sent_ - told_;
    if (bytes.size() > fresh) bytes.remove_prefix(bytes.size() - fresh);
    if (said_.size() + bytes.size() > most_kept) {
      const std::size_t many = std::min(said_.size(), most_kept / 2);
      said_.erase(0, many);
      lost_ += many;
    }
    said_ += bytes;
  }
  /// Takes the kept output. `lost`: bytes before it that were dropped.
  std::string take(uint64_t& lost) {
    lost = std::exchange(lost_, 0);
    return std::exchange(said_, {});
  }
  /// Output that was not taken.
  const std::string& said() const { return said_; }
  /// Drops its first bytes, as if taken.
  void pass(std::size_t bytes) { said_.erase(0, bytes); }

  /// Bytes of output since the start. After the guest went back in time, bytes before `told` are
  /// not kept again.
  uint64_t sent() const { return sent_; }
  struct Told {
    uint64_t told = 0;  ///< bytes since the start
    std::string said;   ///< the last of these, which were not taken
    uint64_t lost = 0;
  };
  Told told() const { return {known(), said_, lost_}; }
  uint64_t known() const { return std::max(sent_, told_); }
  /// True if its next output was reported before.
  bool repeats() const { return sent_ < told_; }
  void set_told(Told told) {
    told_ = told.told;
    said_ = std::move(told.said);
    lost_ = told.lost;
  }
  /// The guest continues from a state in which it had sent `sent` bytes, the last of which are
  /// `said`.
  void go_on_from(uint64_t sent, std::string said) {
    sent_ = sent;
    set_told({sent, std::move(said), 0});
  }
  /// Keeps no output until set_told().
  void mute() { told_ = UINT64_MAX; }
  /// The output from now on is new, even if the guest went back in time.
  void forget_told() { told_ = sent_; }

  /// From here on the guest's reads wait for input, and ask for it by this.
  void ask_by(std::function<void()> ask) { ask_ = std::move(ask); }
  /// Asks for input; false: none will come, a read with none left is at the end of the input.
  bool asks() {
    if (!ask_ || is_at_end_) return false;
    ask_();
    return true;
  }
  void give(std::string_view bytes) { given_ += bytes; }
  /// After what was given nothing comes.
  void end_input() { is_at_end_ = true; }
  bool has_ended() const { return is_at_end_; }
  /// The next line of input, or the rest.
  std::string read() {
    const std::size_t end = given_.find('\n');
    std::string line = given_.substr(0, end == std::string::npos ? end : end + 1);
    given_.erase(0, line.size());
    return line;
  }
  const std::string& given() const { return given_; }

 private:
  std::string said_, given_;
  uint64_t lost_ = 0, sent_ = 0, told_ = 0;
  std::function<void()> ask_;
  bool is_at_end_ = false;
};

/// The backend of such a stream. The stream must outlive it.
class KeptBackend final : public CharacterBackend {
 public:
  explicit KeptBackend(KeptStream& stream) : stream_(stream) {}
  void write(std::string_view bytes) override { stream_.say(bytes); }
  std::string read() override { return stream_.read(); }
  bool asks() override { return stream_.asks(); }

 private:
  KeptStream& stream_;
};

/// For a run whose client uses the standard streams for something else.
struct KeptStreams {
  KeptStream itm, console;
};

}  // namespace capsoc::serial
