// Both ends of a serial line (8N1) as the host has them, a clock at a time.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <deque>

namespace capsoc::rtl_board_test {

class SerialLine {
 public:
  explicit SerialLine(unsigned clocks_per_bit) : clocks_per_bit_(clocks_per_bit) {}

  /// Queues a byte. `stop`: the stop bit, false makes a framing error.
  void send(uint8_t byte, bool stop = true) {
    level(false, clocks_per_bit_);
    for (unsigned bit = 0; bit < 8; ++bit) level(byte >> bit & 1, clocks_per_bit_);
    level(stop, clocks_per_bit_);
  }

  /// Queues a level for a number of clocks.
  void level(bool value, unsigned clocks) { out_.insert(out_.end(), clocks, value); }

  bool sending() const { return !out_.empty(); }

  /// What the line to the board has in this clock.
  bool next() {
    if (out_.empty()) return true;
    const bool value = out_.front();
    out_.pop_front();
    return value;
  }

  /// The line from the board has `value` in this clock.
  void observe(bool value) {
    if (clock_ == 0) {
      if (value) return;
      byte_ = 0;
    }
    const unsigned bit = clock_ / clocks_per_bit_;
    if (clock_ % clocks_per_bit_ == 0) first_ = value;
    EXPECT_EQ(value, first_) << "a bit changes within its time";
    if (bit >= 1 && bit <= 8) {
      byte_ = static_cast<uint8_t>(byte_ | (value ? 1u << (bit - 1) : 0));
    } else {
      EXPECT_EQ(value, bit == 9) << "start or stop bit";
    }
    if (++clock_ == 10 * clocks_per_bit_) {
      received.push_back(byte_);
      clock_ = 0;
    }
  }

  std::deque<uint8_t> received;

 private:
  unsigned clocks_per_bit_;
  std::deque<bool> out_;
  unsigned clock_ = 0;  // of the byte from the board
  bool first_ = true;
  uint8_t byte_ = 0;
};

}  // namespace capsoc::rtl_board_test
