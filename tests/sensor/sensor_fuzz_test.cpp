// Damaged files: whatever the bytes, reading ends with a value or with one sentence that names the
// file. The seeds are fixed, so a failure repeats.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include "sensor/described_source.h"
#include "sensor/random.h"
#include "sensor/recorded_source.h"
#include "sensor/toml_reader.h"

namespace capsoc::sensor {
namespace {

constexpr uint64_t cases = 4000;

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Changes, inserts, removes or repeats bytes in up to eight places.
std::string damaged(std::string text, uint64_t number) {
  const RandomSequence random(number, 99);
  uint64_t draw = 0;
  const auto below = [&](uint64_t limit) { return limit ? random.word(draw++) % limit : 0; };
  for (uint64_t edits = 1 + below(8); edits > 0 && !text.empty(); --edits) {
    const size_t place = below(text.size());
    // Mostly characters that mean something to one of the formats.
    static const std::string likely = "0123456789.,-+eE\n\r\t \"'[]{}=#_naif";
    const char byte = below(4) ? likely[below(likely.size())] : static_cast<char>(below(256));
    switch (below(4)) {
      case 0:
        text[place] = byte;
        break;
      case 1:
        text.insert(place, 1, byte);
        break;
      case 2:
        text.erase(place, 1 + below(20));
        break;
      default:
        text.insert(place, text.substr(below(text.size()), 1 + below(40)));
    }
  }
  return text;
}

void expect_sentence(const std::string& error, const std::string& file, uint64_t number) {
  EXPECT_EQ(error.rfind(file + ":", 0), 0u) << number << ": " << error;
  for (const char c : error) EXPECT_TRUE(c >= 0x20 && c < 0x7F) << number << ": " << error;
}

TEST(SensorFuzz, DamagedDescriptionsEndInAValueOrASentence) {
  const std::string whole = content("traces/soc_experiment.toml") +
                            "[speed_disturbance]\nscale = 1e-2\nrecord_samples = 100\nseed = 1\n";
  ASSERT_GT(whole.size(), 200u);
  uint64_t good = 0;
  for (uint64_t number = 0; number < cases; ++number) {
    const Result<SignalConfig> result = read_signal_toml(damaged(whole, number), "f.toml");
    if (!result) {
      expect_sentence(result.error(), "f.toml", number);
      continue;
    }
    ++good;
    DescribedSource source(result.value());
    const auto value = source.sample(3, 0.012);
    if (!value) continue;
    EXPECT_TRUE(std::isfinite(value->u) && std::isfinite(value->v)) << number;
  }
  // Both outcomes must occur, or the damage is not worth its name.
  EXPECT_GT(good, cases / 20);
  EXPECT_LT(good, cases * 19 / 20);
}

TEST(SensorFuzz, DamagedRecordingsEndInAValueOrASentence) {
  const std::string whole = content("traces/recorded_example.csv").substr(0, 3000);
  ASSERT_GT(whole.size(), 2000u);
  uint64_t good = 0;
  for (uint64_t number = 0; number < cases; ++number) {
    Result<RecordedSource> result = read_recording(damaged(whole, number), "f.csv");
    if (!result) {
      expect_sentence(result.error(), "f.csv", number);
      continue;
    }
    ++good;
    const auto value = result.value().sample(0, 0.0);
    ASSERT_TRUE(value) << number;
    EXPECT_TRUE(std::isfinite(value->u) && std::isfinite(value->v)) << number;
    EXPECT_TRUE(value->angle_turns >= 0.0 && value->angle_turns < 1.0) << number;
  }
  EXPECT_GT(good, cases / 50);
  EXPECT_LT(good, cases * 19 / 20);
}

}  // namespace
}  // namespace capsoc::sensor
