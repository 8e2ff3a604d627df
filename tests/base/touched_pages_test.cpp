#include "base/touched_pages.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>

#include "base/archive.h"

namespace capsoc {
namespace {

constexpr std::size_t size = std::size_t{8} << 20;

struct Release {
  void operator()(uint8_t* bytes) const { std::free(bytes); }
};
using Zeros = std::unique_ptr<uint8_t, Release>;

Zeros zeros() {
  return Zeros(static_cast<uint8_t*>(std::calloc(size, 1)));
}

TEST(TouchedPages, WhatWasWrittenIsTouched) {
  const Zeros memory = zeros();
  for (const std::size_t at : {std::size_t{0}, size / 3, size - 1}) memory.get()[at] = 1;
  const TouchedPages touched(memory.get(), size);
  for (const std::size_t at : {std::size_t{0}, size / 3, size - 1})
    EXPECT_TRUE(touched.any(at, 1)) << at;
  EXPECT_TRUE(touched.any(0, size));
}

TEST(TouchedPages, OfALittleEveryPageCounts) {
  const uint8_t little[16] = {};
  EXPECT_TRUE(TouchedPages(little, sizeof little).any(3, 5));
}

TEST(TouchedPages, AMemoryIsSavedAndLoadedWhole) {
  const Zeros from = zeros(), to = zeros();
  for (std::size_t at = 5; at < size; at += 100'003) from.get()[at] = static_cast<uint8_t>(at | 1U);
  for (std::size_t at = 9; at < size; at += 300'007) to.get()[at] = 7;
  StateWriter writer;
  writer.memory("bytes", from.get(), size);
  const std::string bytes = writer.take();
  StateReader reader(bytes);
  reader.memory("bytes", to.get(), size);
  ASSERT_TRUE(reader.ok());
  EXPECT_EQ(std::memcmp(from.get(), to.get(), size), 0);
}

}  // namespace
}  // namespace capsoc
