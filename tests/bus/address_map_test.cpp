#include "bus/address_map.h"

#include <gtest/gtest.h>

#include <set>

#include "bus/address_decoder.h"

namespace capsoc::bus {
namespace {

MapEntry entry(const char* name, uint64_t base, uint64_t size) {
  MapEntry made;
  made.name = made.target = name;
  made.base = base;
  made.size = size;
  return made;
}

bool mentions(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Validation, AcceptsNeighboursThatTouch) {
  EXPECT_EQ(validate({entry("a", 0x1000, 0x1000), entry("b", 0x2000, 4)}), "");
}

TEST(Validation, NamesBothSidesOfAnOverlap) {
  const std::string text = validate({entry("b", 0x1ffc, 8), entry("a", 0x1000, 0x1000)});
  EXPECT_TRUE(mentions(text, "'a'") && mentions(text, "'b'") && mentions(text, "overlaps")) << text;
}

TEST(Validation, FindsAnOverlapBehindASmallRangeInsideALargeOne) {
  const std::string text =
      validate({entry("large", 0, 0x1000), entry("small", 4, 4), entry("late", 0x800, 4)});
  EXPECT_TRUE(mentions(text, "'late'")) << text;
}

TEST(Validation, RefusesWhatCannotBeDecoded) {
  EXPECT_TRUE(mentions(validate({entry("a", 2, 4)}), "aligned"));
  EXPECT_TRUE(mentions(validate({entry("a", 0, 6)}), "aligned"));
  EXPECT_TRUE(mentions(validate({entry("a", 0, 0)}), "size 0"));
  EXPECT_TRUE(mentions(validate({entry("", 0, 4)}), "no name"));
  EXPECT_TRUE(mentions(validate({entry("a", 0xfffff000, 0x2000)}), "past the 32-bit"));
  EXPECT_TRUE(mentions(validate({entry("a", 0, ~uint64_t{3})}), "past the 32-bit"));
  EXPECT_TRUE(mentions(validate({entry("a", 0, 4), entry("a", 8, 4)}), "used twice"));
}

TEST(Validation, RefusesAWindowThatDoesNotDivideItsRange) {
  MapEntry repeated = entry("a", 0, 0x1000);
  repeated.wrap = 0xc00;
  EXPECT_TRUE(mentions(validate({repeated}), "whole number"));
  repeated.wrap = 0x400;
  EXPECT_EQ(validate({repeated}), "");
}

TEST(Validation, RefusesOneTargetOnTwoBuses) {
  MapEntry far = entry("b", 8, 4);
  far.target = "a";
  far.bus = BusKind::apb;
  EXPECT_TRUE(mentions(validate({entry("a", 0, 4), far}), "both AHB and APB"));
}

TEST(Validation, ReportsEveryFaultOnItsOwnLine) {
  EXPECT_TRUE(mentions(validate({entry("a", 2, 4), entry("b", 0, 0)}), "\n"));
}

TEST(Decoder, OfAnUnsoundMapDecodesNothingAndSaysWhy) {
  const AddressDecoder decoder({entry("a", 0, 8), entry("b", 4, 8)});
  EXPECT_FALSE(decoder.error().empty());
  EXPECT_EQ(decoder.decode(0).entry, nullptr);
}

TEST(Decoder, GivesTheExtentOfTheGapBetweenTwoRanges) {
  const AddressDecoder decoder({entry("a", 0x1000, 0x1000), entry("b", 0x4000, 0x1000)});
  EXPECT_EQ(decoder.decode(0).window_last, 0xfffu);
  EXPECT_EQ(decoder.decode(0x3000).entry, nullptr);
  EXPECT_EQ(decoder.decode(0x3000).window_base, 0x2000u);
  EXPECT_EQ(decoder.decode(0x3000).window_last, 0x3fffu);
  EXPECT_EQ(decoder.decode(0x5000).window_base, 0x5000u);
}

TEST(Decoder, FindsFirstAndLastByteOfARange) {
  const AddressDecoder decoder({entry("a", 0x1000, 0x1000)});
  EXPECT_EQ(decoder.decode(0xfff).entry, nullptr);
  EXPECT_EQ(decoder.decode(0x1000).local, 0u);
  EXPECT_EQ(decoder.decode(0x1fff).local, 0xfffu);
  EXPECT_EQ(decoder.decode(0x2000).entry, nullptr);
}
}  // namespace
}  // namespace capsoc::bus
