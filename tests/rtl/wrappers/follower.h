// The model next to a coprocessor whose bus accesses are known only when they are over, and traffic
// for both.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <optional>
#include <random>

#include "coprocessor/coprocessor.h"
#include "coprocessor/register_map.h"

namespace capsoc::rtl_wrappers_test {

/// The state of the sample port in one interval.
struct SamplePins {
  bool valid = false, clip = false, ready = false;
  uint32_t u = 0, v = 0;
};

/// An access of the coprocessor's APB, with what the bus around it answered.
struct Access {
  bool write = false;
  uint32_t address = 0;
  uint32_t data = 0;  // written, or read if there was no error
  uint8_t strobes = 0;
  bool error = false;
};

/// Compares a coprocessor with the model, an interval at a time.
class Follower {
 public:
  explicit Follower(coprocessor::Options options) : model_(options) {}

  /// Interval `edge` - 1 is over, in which `access` ended and `sample` was on the pins. Interval
  /// `edge` shows `irq` and `idle`.
  void follow(uint64_t edge, const std::optional<Access>& access, const SamplePins& sample,
              bool irq, bool idle) {
    if (access && !access->write) {
      const auto read = model_.read(edge - 1, access->address, false);
      EXPECT_EQ(access->error, !read.ok) << "read of " << access->address << " at edge " << edge;
      if (read.ok) {
        EXPECT_EQ(access->data, read.value) << "read of " << access->address << " at edge " << edge;
      }
    }
    if (sample.valid) {
      const bool taken = model_.submit(edge, static_cast<int32_t>(sample.u),
                                       static_cast<int32_t>(sample.v), sample.clip);
      EXPECT_EQ(sample.ready, taken) << "sample at edge " << edge;
      ++(taken ? taken_ : refused_);
    }
    if (access && access->write) {
      const bool written = model_.write_bytes(edge, access->address, access->data, access->strobes);
      EXPECT_EQ(access->error, !written) << "write of " << access->address << " at edge " << edge;
    }
    model_.advance(edge);
    EXPECT_EQ(irq, model_.interrupt()) << "interrupt at edge " << edge;
    EXPECT_EQ(idle, model_.idle()) << "idle at edge " << edge;
  }

  unsigned taken() const { return taken_; }
  unsigned refused() const { return refused_; }

 private:
  coprocessor::Coprocessor model_;
  unsigned taken_ = 0, refused_ = 0;  // samples
};

/// Random values for buses and sample ports. The same seed gives the same values.
class Stimulus {
 public:
  explicit Stimulus(uint64_t seed) : random_(seed) {}

  uint32_t below(uint32_t bound) { return static_cast<uint32_t>(random_() % bound); }
  bool one_in(uint32_t count) { return below(count) == 0; }
  uint32_t word() { return static_cast<uint32_t>(random_()); }

  /// Mostly registers; gaps of the map, and addresses above it.
  uint32_t address() { return one_in(16) ? below(0x1000) : 4 * below(64); }

  /// For a write to `address`. Resets are rare, and the sample port is mostly enabled.
  uint32_t data(uint32_t address) {
    using namespace coprocessor;
    if (address != reg_ctrl) return one_in(4) ? below(4) : word() >> below(32);
    if (one_in(32)) return ctrl_srst;
    return (word() & ~ctrl_srst & ~ctrl_adc) | (one_in(4) ? 0 : ctrl_adc);
  }

  /// A sample now and then; at times one follows another at once.
  SamplePins sample() {
    SamplePins pins;
    pins.valid = one_in(burst_ ? 8 : 128);
    if (one_in(256)) burst_ = !burst_;
    pins.u = word();
    pins.v = word();
    pins.clip = one_in(8);
    return pins;
  }

 private:
  std::mt19937_64 random_;
  bool burst_ = false;
};

}  // namespace capsoc::rtl_wrappers_test
