#include "soc/board_map.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <string>

#include "bus/address_decoder.h"

namespace capsoc::soc {
namespace {

using bus::AddressDecoder, bus::AddressMap, bus::Decoded, bus::InterruptWire, bus::MapEntry;

class BoardMap : public testing::Test {
 protected:
  AddressMap map = board_map();
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

TEST_F(BoardMap, IsSound) {
  EXPECT_EQ(validate(map), "");
}

TEST_F(BoardMap, HasTheMemoriesOfTheBoard) {
  EXPECT_EQ(target_at(0x00000000), "code_sram");
  EXPECT_EQ(target_at(0x003fffff), "code_sram");
  EXPECT_EQ(target_at(0x20000000), "data_sram");
  EXPECT_EQ(target_at(0x21ffffff), "psram");
  EXPECT_EQ(decoder.decode(0x00400010).local, 0x10u);
  EXPECT_EQ(target_at(0x00400010), "code_sram");
  EXPECT_EQ(target_at(0x20400010), "data_sram");
  EXPECT_EQ(decoder.decode(0x20400010).local, 0x10u);
}

TEST_F(BoardMap, RepeatsTheBlockRamEverySixteenKibibytes) {
  for (uint64_t base : {0x01000000, 0x01004000, 0x01008000, 0x0100c000}) {
    EXPECT_EQ(target_at(base + 8), "block_ram");
    EXPECT_EQ(decoder.decode(base + 8).local, 8u);
  }
  EXPECT_EQ(target_at(0x01010000), "reserved_2");
}

TEST_F(BoardMap, PlacesTheModelledDevices) {
  EXPECT_EQ(target_at(0x40000000), "timer0");
  EXPECT_EQ(target_at(0x40001000), "timer1");
  EXPECT_EQ(target_at(0x40004000), "uart0");
  EXPECT_EQ(target_at(0x4000c000), "coprocessor");
  EXPECT_EQ(target_at(0x4000d000), "adc_front_end");
  EXPECT_EQ(target_at(0x4000e000), "clock_controller");
  EXPECT_EQ(target_at(0x40010000), "gpio0");
}

TEST_F(BoardMap, WiresTheInterruptsOfTheBoard) {
  EXPECT_EQ(lines_of("timer0"), std::set<int>({8}));
  EXPECT_EQ(lines_of("timer1"), std::set<int>({9}));
  EXPECT_EQ(lines_of("dual_timer"), std::set<int>({10}));
  EXPECT_EQ(lines_of("uart0"), std::set<int>({0, 1, 12}));
  EXPECT_EQ(lines_of("uart1"), std::set<int>({2, 3, 12}));
  EXPECT_EQ(lines_of("uart2"), std::set<int>({4, 5, 12}));
  EXPECT_EQ(lines_of("uart3"), std::set<int>({18, 19, 12}));
  EXPECT_EQ(lines_of("uart4"), std::set<int>({20, 21, 12}));
  EXPECT_EQ(lines_of("watchdog"), std::set<int>({bus::nmi_line}));
  EXPECT_EQ(lines_of("gpio0"), std::set<int>({6}));
  EXPECT_EQ(lines_of("gpio3"), std::set<int>({17}));
  EXPECT_EQ(lines_of("ethernet"), std::set<int>({13}));
  EXPECT_EQ(lines_of("spi0"), std::set<int>({11}));
  EXPECT_EQ(lines_of("spi2"), std::set<int>({22}));
  EXPECT_EQ(lines_of("spi3"), std::set<int>({24}));
  EXPECT_EQ(lines_of("coprocessor"), std::set<int>({30}));
  EXPECT_EQ(lines_of("adc_front_end"), std::set<int>({31}));
}

TEST_F(BoardMap, HasNoHoleInThePeripheralRegion) {
  for (uint64_t page = 0x40000000; page < 0x40300000; page += 0x1000)
    EXPECT_NE(target_at(page), "") << std::hex << page;
}

TEST_F(BoardMap, LeavesTheRestToTheBusError) {
  EXPECT_EQ(target_at(0x22000000), "");  // the processor decodes the bit-band alias
  EXPECT_EQ(target_at(0x40300000), "");
  EXPECT_EQ(target_at(0x60000000), "");
  EXPECT_EQ(target_at(0xe0000000), "");
}

TEST_F(BoardMap, FindsEntriesByName) {
  EXPECT_EQ(find_entry(map, "uart0")->base, 0x40004000u);
  EXPECT_EQ(find_entry(map, "uart9"), nullptr);
}

}  // namespace
}  // namespace capsoc::soc
