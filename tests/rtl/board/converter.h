// The converter MAX11125 as its data sheet (MAX11120-MAX11128) describes it at its pins, as far as
// the board uses it: frames of 16 bits, the ADC mode control register, and manual (external clock)
// mode.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

namespace capsoc::rtl_board_test {

class Converter {
 public:
  /// The code (0 to 4095) of a channel at this moment.
  using Input = std::function<uint16_t(unsigned channel)>;

  /// `latency`: frames from a command to its answer, 1 or 2.
  Converter(unsigned latency, Input input) : latency_(latency), input_(std::move(input)) {}

  /// One clock of the board. What DOUT shows changes a clock after SCLK falls.
  void clock(bool csn, bool sclk, bool din) {
    dout_ = next_dout_;
    ++since_edge_;
    if (csn_ && !csn) begin_frame(sclk);
    if (!csn && sclk_ != sclk) {
      EXPECT_GE(since_edge_, 2u) << "SCLK is faster than the board says";
      since_edge_ = 0;
      if (sclk) {
        received_ = static_cast<uint16_t>(received_ << 1 | (din ? 1 : 0));
        ++bits_;
      } else {
        next_dout_ = answer_ >> 15 & 1;
        answer_ = static_cast<uint16_t>(answer_ << 1);
      }
    }
    EXPECT_TRUE(sclk || !csn) << "SCLK is idle at 1";
    if (!csn_ && csn) end_frame();
    csn_ = csn;
    sclk_ = sclk;
  }

  bool dout() const { return stuck_.value_or(dout_); }

  /// DOUT keeps this value, as if no converter were there.
  void stick(std::optional<bool> value) { stuck_ = value; }

  /// From now on answer `number` (from 0) has these bits inverted. No mask: no answer.
  void disturb(unsigned number, uint16_t mask) {
    disturbed_ = answers_ + number;
    mask_ = mask;
  }

  /// The newest code of a channel since the last call; none if there was no conversion.
  std::optional<uint16_t> take(unsigned channel) { return std::exchange(codes_[channel], {}); }

  unsigned conversions() const { return answers_; }
  unsigned resets() const { return resets_; }

 private:
  void begin_frame(bool sclk) {
    EXPECT_TRUE(sclk) << "CS falls while SCLK is 1";
    bits_ = 0;
    received_ = 0;
    uint16_t result = 0;
    if (manual_) {
      const uint16_t code = input_(channel_);
      EXPECT_FALSE(codes_[channel_] && channel_ < 2)
          << "two conversions of channel " << channel_ << " in one pair";
      codes_[channel_] = code;
      // Without CHAN_ID: 0, the code, 000.
      result = static_cast<uint16_t>(with_channel_ ? channel_ << 12 | code : code << 3);
      if (answers_++ == disturbed_) result ^= mask_;
    }
    answer_ = latency_ == 1 ? result : std::exchange(before_, result);
  }

  void end_frame() {
    EXPECT_EQ(bits_, 16u) << "SCLK periods of a frame";
    ASSERT_EQ(received_ >> 15, 0) << "only the ADC mode control register is written";
    EXPECT_EQ(received_ & 1, 0);
    const unsigned scan = received_ >> 11 & 15, reset = received_ >> 5 & 3,
                   power = received_ >> 3 & 3;
    EXPECT_EQ(power, 0u) << "normal power";
    if (reset == 2) {
      ++resets_;
      manual_ = with_channel_ = false;
      known_ = true;
      return;
    }
    ASSERT_EQ(scan, 1u) << "manual mode";
    EXPECT_TRUE(known_) << "the registers are as they were at power-on: unknown";
    manual_ = true;
    channel_ = received_ >> 7 & 15;
    with_channel_ = received_ >> 2 & 1;
  }

  unsigned latency_;
  Input input_;
  bool csn_ = true, sclk_ = true, dout_ = true, next_dout_ = true;
  std::optional<bool> stuck_;
  unsigned bits_ = 0, since_edge_ = 0, channel_ = 0, answers_ = 0, resets_ = 0;
  unsigned disturbed_ = ~0u;
  uint16_t received_ = 0, answer_ = 0, before_ = 0, mask_ = 0;
  bool manual_ = false, with_channel_ = false, known_ = false;
  std::array<std::optional<uint16_t>, 16> codes_;
};

}  // namespace capsoc::rtl_board_test
