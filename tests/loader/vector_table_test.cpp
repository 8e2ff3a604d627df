#include "loader/vector_table.h"

#include <gtest/gtest.h>

namespace capsoc::loader {
namespace {

/// Eight bytes of a vector table with this start.
Segment table(uint32_t address, uint32_t start) {
  Segment segment{address, {0, 0, 1, 0x20}, 8};
  for (unsigned i = 0; i < 4; ++i) segment.bytes.push_back(static_cast<uint8_t>(start >> (8 * i)));
  return segment;
}

ElfImage image(uint32_t entry, std::vector<Segment> segments) {
  ElfImage made;
  made.path = "program.elf";
  made.entry = entry;
  made.segments = std::move(segments);
  return made;
}

void expect_at(uint32_t address, const ElfImage& program) {
  const auto found = find_vector_table({&program}, "auto");
  ASSERT_TRUE(found) << found.error();
  EXPECT_EQ(found.value(), address);
}

TEST(VectorTable, IsAtZeroIfAnythingIs) {
  expect_at(0, image(0x21000101, {table(0x21000000, 0x21000101), table(0, 1)}));
}

TEST(VectorTable, IsTheFirstSegmentThatBeginsWithOne) {
  const auto other = table(0x20000000, 0x12345679), real = table(0x21000080, 0x21000101),
             later = table(0x21800000, 0x21000101);
  expect_at(0x21000080, image(0x21000101, {later, other, real}));
  expect_at(0x21000080, image(0x21000100, {real}));
}

TEST(VectorTable, IsRefusedWhereNoneCanBe) {
  const auto program = image(0x21000101, {table(0x21000040, 0x21000101)});
  EXPECT_FALSE(find_vector_table({&program}, "auto")) << "not aligned";
  const auto even = image(0x21000100, {table(0x21000000, 0x21000100)});
  EXPECT_FALSE(find_vector_table({&even}, "auto")) << "no Thumb bit";
  const auto cut = image(0x21000101, {{0x21000000, {0, 0, 0, 0}, 8}});
  EXPECT_FALSE(find_vector_table({&cut}, "auto")) << "too short";
  const auto none = find_vector_table({&program}, "auto");
  EXPECT_EQ(none.error().rfind("program.elf: ", 0), 0U) << none.error();
}

TEST(VectorTable, IsWhereTheUserSays) {
  const auto program = image(1, {table(0, 1)});
  const auto found = find_vector_table({&program}, "0x20000080");
  ASSERT_TRUE(found) << found.error();
  EXPECT_EQ(found.value(), 0x20000080U);
  for (const char* bad :
       {"", "x", "0x", "0x20000081", "0x40000000", "-0x80", "128 ", "1e3", "99999999999999999999"})
    EXPECT_FALSE(find_vector_table({&program}, bad)) << bad;
}

}  // namespace
}  // namespace capsoc::loader
