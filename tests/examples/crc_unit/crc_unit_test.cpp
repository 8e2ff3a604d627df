// The example of docs/developer/extending.md: a custom device on the SoC, with its driver.
#include "crc_unit.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "loader/elf_image.h"
#include "loader/place.h"

namespace {

using capsoc::armv7m::Core;

TEST(CrcUnit, WorksWithItsDriver) {
  sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
  capsoc::soc::Config config;
  config.devices = {{"reserved_apb_3", make_crc_unit}};
  capsoc::soc::Soc soc("soc", config);
  const auto image = capsoc::loader::load_elf(CRC_UNIT_ELF);
  ASSERT_TRUE(image) << image.error();
  ASSERT_FALSE(capsoc::loader::place(image.value(), soc));

  std::string text;
  const auto listening =
      soc.uart0.transmitted.listen([&text](uint8_t byte) { text += static_cast<char>(byte); });
  uint32_t status = ~0U;
  soc.cpu.core().listeners().semihosting =
      [&status](Core& core) {  // SYS_EXIT_EXTENDED: reason, status
        core.debug_read(core.reg(1) + 4, &status, sizeof status);
        return false;
      };
  soc.cpu.set_interrupted(
      [] { return sc_core::sc_time_stamp() > sc_core::sc_time(1, sc_core::SC_SEC); });
  sc_core::sc_start();
  EXPECT_EQ(status, 0U);
  EXPECT_EQ(text, "crc: right\n");

  soc.reset_peripherals();
  EXPECT_EQ(soc.peek(0x40003004), 0U) << "no word, no sum";
}

}  // namespace

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
