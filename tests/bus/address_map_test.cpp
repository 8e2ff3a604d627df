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

class SocMap : public testing::Test {
 protected:
  AddressMap map = soc_address_map();
  AddressDecoder decoder{map};

  std::string target_at(uint64_t address) const {
    const Decoded at = decoder.decode(address);
    return at.entry == nullptr ? "" : at.entry->target;
  }
  std::set<int> lines_of(const std::string& name) const {
    std::set<int> lines;
    for (const InterruptWire& wire : find_entry(map, name)->interrupts) lines.insert(wire.line);
    return lines;
  }
};

TEST_F(SocMap, IsSound) {
  EXPECT_EQ(validate(map), "");
}

TEST_F(SocMap, HasTheMemoriesOfTheBoard) {
  EXPECT_EQ(target_at(0x00000000), "code_sram");
  EXPECT_EQ(target_at(0x003fffff), "code_sram");
  EXPECT_EQ(target_at(0x20000000), "data_sram");
  EXPECT_EQ(target_at(0x21ffffff), "psram");
  EXPECT_EQ(decoder.decode(0x00400010).local, 0x10u);
  EXPECT_EQ(target_at(0x00400010), "code_sram");
  EXPECT_EQ(target_at(0x20400010), "data_sram");
  EXPECT_EQ(decoder.decode(0x20400010).local, 0x10u);
}

TEST_F(SocMap, RepeatsTheBlockRamEverySixteenKibibytes) {
  for (uint64_t base : {0x01000000, 0x01004000, 0x01008000, 0x0100c000}) {
    EXPECT_EQ(target_at(base + 8), "block_ram");
    EXPECT_EQ(decoder.decode(base + 8).local, 8u);
  }
  EXPECT_EQ(target_at(0x01010000), "reserved_2");
}

TEST_F(SocMap, PlacesTheModelledDevices) {
  EXPECT_EQ(target_at(0x40000000), "timer0");
  EXPECT_EQ(target_at(0x40001000), "timer1");
  EXPECT_EQ(target_at(0x40004000), "uart0");
  EXPECT_EQ(target_at(0x4000c000), "coprocessor");
  EXPECT_EQ(target_at(0x4000d000), "adc_front_end");
  EXPECT_EQ(target_at(0x4000e000), "clock_controller");
  EXPECT_EQ(target_at(0x40010000), "gpio0");
}

TEST_F(SocMap, WiresTheInterruptsOfTheBoard) {
  EXPECT_EQ(lines_of("timer0"), std::set<int>({8}));
  EXPECT_EQ(lines_of("timer1"), std::set<int>({9}));
  EXPECT_EQ(lines_of("dual_timer"), std::set<int>({10}));
  EXPECT_EQ(lines_of("uart0"), std::set<int>({0, 1, 12}));
  EXPECT_EQ(lines_of("uart1"), std::set<int>({2, 3, 12}));
  EXPECT_EQ(lines_of("uart2"), std::set<int>({4, 5, 12}));
  EXPECT_EQ(lines_of("uart3"), std::set<int>({18, 19, 12}));
  EXPECT_EQ(lines_of("uart4"), std::set<int>({20, 21, 12}));
  EXPECT_EQ(lines_of("watchdog"), std::set<int>({nmi_line}));
  EXPECT_EQ(lines_of("gpio0"), std::set<int>({6}));
  EXPECT_EQ(lines_of("gpio3"), std::set<int>({17}));
  EXPECT_EQ(lines_of("ethernet"), std::set<int>({13}));
  EXPECT_EQ(lines_of("spi0"), std::set<int>({11}));
  EXPECT_EQ(lines_of("spi2"), std::set<int>({22}));
  EXPECT_EQ(lines_of("spi3"), std::set<int>({24}));
  EXPECT_EQ(lines_of("coprocessor"), std::set<int>({30}));
  EXPECT_EQ(lines_of("adc_front_end"), std::set<int>({31}));
}

TEST_F(SocMap, HasNoHoleInThePeripheralRegion) {
  for (uint64_t page = 0x40000000; page < 0x40300000; page += 0x1000)
    EXPECT_NE(target_at(page), "") << std::hex << page;
}

TEST_F(SocMap, LeavesTheRestToTheBusError) {
  EXPECT_EQ(target_at(0x22000000), "");  // the bit-band alias is the processor's affair
  EXPECT_EQ(target_at(0x40300000), "");
  EXPECT_EQ(target_at(0x60000000), "");
  EXPECT_EQ(target_at(0xe0000000), "");
}

TEST_F(SocMap, FindsEntriesByName) {
  EXPECT_EQ(find_entry(map, "uart0")->base, 0x40004000u);
  EXPECT_EQ(find_entry(map, "uart9"), nullptr);
}

}  // namespace
}  // namespace capsoc::bus
