// Random traffic over the Device interface: samples, accesses of every kind, commands, soft resets.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "coprocessor/device.h"
#include "coprocessor/register_map.h"

namespace capsoc::rtl::test {

using coprocessor::Device;

/// What a device answered, in order; equal traffic gives equal answers.
using Answers = std::vector<uint64_t>;

class Traffic {
 public:
  /// `gap`: bound of the cycles from one operation to the next.
  explicit Traffic(uint64_t seed, uint64_t gap = 40) : random_(seed), gap_(gap) {}

  /// `count` operations from cycle `cycle` on. Returns the last cycle.
  uint64_t run(Device& device, int count, uint64_t cycle, Answers& answers) {
    using namespace coprocessor;
    cycle += 2;
    device.write(cycle, reg_ctrl, control());
    for (int i = 0; i < count; ++i) {
      cycle += pick(4) == 0 ? pick(10 * gap_) + 2 : pick(gap_) + 2;
      const unsigned kind = pick(16);
      if (kind < 9) {
        answers.push_back(device.submit(cycle, word(), word(), pick(16) == 0));
        if (pick(8) == 0) answers.push_back(write(device, cycle));
      } else if (kind < 12) {
        answers.push_back(write(device, cycle));
      } else {
        const auto offset = static_cast<uint32_t>(pick(64) * 4 + (pick(32) == 0 ? 2 : 0));
        const RegisterAccess access = device.read(cycle, offset, pick(4) == 0);
        answers.push_back(access.ok);
        answers.push_back(access.value);
      }
      if (pick(4) == 0) {
        answers.push_back(device.interrupt());
        answers.push_back(device.idle());
        answers.push_back(device.next_event().value_or(0));
        answers.push_back(device.nodes().commits);
        ++cycle;
      }
    }
    return cycle;
  }

 private:
  uint64_t pick(uint64_t bound) { return random_() % bound; }

  uint32_t control() {
    using namespace coprocessor;
    return ctrl_adc | ctrl_demod | ctrl_calib | ctrl_ie_result | ctrl_ie_lock | ctrl_ie_error |
           static_cast<uint32_t>(pick(3) << ctrl_ref_shift);
  }

  int32_t word() {
    const auto any = static_cast<int32_t>(random_());
    switch (pick(8)) {
      case 0:
        return 0;
      case 1:
        return any >> (random_() % 31);
      case 2:
        return any < 0 ? INT32_MIN : INT32_MAX;
      default:
        return any;
    }
  }

  bool write(Device& device, uint64_t cycle) {
    using namespace coprocessor;
    const unsigned kind = pick(64);
    if (kind == 0) return device.write(cycle, reg_ctrl, ctrl_srst);
    if (kind < 6) return device.write(cycle, reg_ctrl, control());
    if (kind < 9) return device.write(cycle, reg_cmd, static_cast<uint32_t>(1u << pick(3)));
    auto offset = static_cast<uint32_t>(pick(64) * 4);
    if (offset == reg_ctrl) offset = reg_soft_v;
    return device.write(cycle, offset, static_cast<uint32_t>(word()));
  }

  std::mt19937_64 random_;
  uint64_t gap_;
};

}  // namespace capsoc::rtl::test
