// The firmware's header describes the same layout as the C++ table.
#include <gtest/gtest.h>

#include <cstddef>

#include "capsoc_device.h"
#include "capsoc_registers.h"

namespace {

namespace table = capsoc::registers;

TEST(DeviceHeader, PutsRegistersAtTheirOffsets) {
  EXPECT_EQ(offsetof(CAPSOC_COPROCESSOR_Type, CTRL), table::coprocessor::CTRL_offset);
  EXPECT_EQ(offsetof(CAPSOC_COPROCESSOR_Type, A1), table::coprocessor::A1_offset);
  EXPECT_EQ(offsetof(CAPSOC_COPROCESSOR_Type, SOFT_U), table::coprocessor::SOFT_U_offset);
  EXPECT_EQ(offsetof(CAPSOC_COPROCESSOR_Type, RAW_U), table::coprocessor::RAW_U_offset);
  EXPECT_EQ(offsetof(CAPSOC_COPROCESSOR_Type, LATENCY), table::coprocessor::LATENCY_offset);
  EXPECT_EQ(offsetof(CAPSOC_ADC_Type, COUNT), table::adc::COUNT_offset);
  EXPECT_EQ(offsetof(CAPSOC_CLOCKCTRL_Type, FREQ), table::clockctrl::FREQ_offset);
}

TEST(DeviceHeader, HasTheAddressesAndInterruptsOfTheBoard) {
  EXPECT_EQ(COPROCESSOR_BASE, 0x4000C000u);
  EXPECT_EQ(ADC_BASE, 0x4000D000u);
  EXPECT_EQ(CLOCKCTRL_BASE, 0x4000E000u);
  EXPECT_EQ(COPROCESSOR_IRQn, 30);
  EXPECT_EQ(ADC_IRQn, 31);
}

TEST(DeviceHeader, AgreesWithTheTableOnFields) {
  EXPECT_EQ(COPROCESSOR_CTRL_REF_Msk, table::coprocessor::CTRL_REF_mask);
  EXPECT_EQ(COPROCESSOR_CTRL_REF_Pos, table::coprocessor::CTRL_REF_shift);
  EXPECT_EQ(COPROCESSOR_CTRL_REF_ANGLE, table::coprocessor::CTRL_REF_angle);
  EXPECT_EQ(CLOCKCTRL_PLL_DIV_Msk, table::clockctrl::PLL_DIV_mask);
}

}  // namespace
