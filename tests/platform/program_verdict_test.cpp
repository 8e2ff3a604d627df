#include "metrics/program_verdict.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

namespace capsoc::run {
namespace {

constexpr uint32_t place = 0x20000100;

loader::ElfImage with_object() {
  loader::ElfImage image;
  image.symbols.push_back({place, 108, "program_verdict"});
  return image;
}

std::vector<uint8_t> object(uint32_t magic, uint32_t state, uint32_t bound, const char* reason) {
  std::vector<uint8_t> bytes(108);
  std::memcpy(bytes.data(), &magic, 4);
  std::memcpy(&bytes[4], &state, 4);
  std::memcpy(&bytes[8], &bound, 4);
  std::memcpy(&bytes[12], reason, std::min<std::size_t>(std::strlen(reason), 96));
  return bytes;
}

metrics::ReadMemory memory(std::vector<uint8_t> bytes) {
  return [bytes = std::move(bytes)](uint32_t address, void* into, uint32_t size) {
    if (address != place || size != bytes.size()) return false;
    std::memcpy(into, bytes.data(), size);
    return true;
  };
}

constexpr uint32_t magic = 0x31524556;

TEST(ProgramVerdict, APassHasABoundThatIsHeldAgainstTheTruth) {
  metrics::AngleErrors errors;
  errors.calibration_mode_max = 44.9;
  errors.calibrated_max_last_revolution = 50;
  const metrics::ReadMemory read = memory(object(magic, 1, 1U << 29U, "unused"));
  const auto verdict = metrics::read_verdict(with_object(), read, errors);
  ASSERT_TRUE(verdict);
  EXPECT_TRUE(verdict->pass);
  EXPECT_DOUBLE_EQ(verdict->bound_deg, 45);
  EXPECT_EQ(verdict->reason, "");
  EXPECT_EQ(verdict->bound_holds(), true);
  errors.calibration_mode_max = 45.1;
  EXPECT_EQ(metrics::read_verdict(with_object(), read, errors)->bound_holds(), false);
  errors.calibration_mode_max.reset();
  EXPECT_EQ(metrics::read_verdict(with_object(), read, errors)->bound_holds(), false)
      << "the last turn";
  EXPECT_EQ(metrics::read_verdict(with_object(), read, {})->bound_holds(), std::nullopt);
}

TEST(ProgramVerdict, AFailHasAReasonAndNothingElse) {
  const auto verdict =
      metrics::read_verdict(with_object(), memory(object(magic, 2, 7, "no\x1b[31m lock")), {});
  ASSERT_TRUE(verdict);
  EXPECT_FALSE(verdict->pass);
  EXPECT_EQ(verdict->reason, "no?[31m lock");
  EXPECT_EQ(verdict->bound_holds(), std::nullopt);
  // Without an end the sentence ends with its field.
  const std::string long_one(200, 'x');
  EXPECT_EQ(metrics::read_verdict(with_object(), memory(object(magic, 2, 7, long_one.c_str())), {})
                ->reason,
            std::string(96, 'x'));
}

TEST(ProgramVerdict, WhatIsNoVerdictIsNone) {
  EXPECT_FALSE(metrics::read_verdict({}, memory(object(magic, 1, 7, "")), {})) << "no such object";
  EXPECT_FALSE(metrics::read_verdict(with_object(), memory(object(magic + 1, 1, 7, "")), {}));
  EXPECT_FALSE(metrics::read_verdict(with_object(), memory(object(magic, 0, 7, "")), {}))
      << "not yet";
  EXPECT_FALSE(metrics::read_verdict(with_object(), memory(object(magic, 3, 7, "")), {}));
  EXPECT_FALSE(metrics::read_verdict(with_object(), memory({}), {})) << "no memory there";
}

}  // namespace
}  // namespace capsoc::run
