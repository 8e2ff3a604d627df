// The board with a monitor of the TLM-2.0 base protocol between every two sockets.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "../elsewhere.h"
#include "loader/elf_image.h"
#include "loader/program_file.h"
#include "soc/soc.h"

namespace capsoc::soc {
namespace {

/// A run of a program up to its end, or for a while, with a debugger that looks at everything.
std::string run(const std::string& program, bool monitor,
                armv7m::Executor executor = armv7m::Executor::translator) {
  return test::elsewhere([&] {
    sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
    Config config;
    config.monitor = monitor;
    config.executor = executor;
    Soc soc("soc", config);
    std::string said;
    const auto listening = soc.protocol.violated.listen(
        [&](const kit::ProtocolViolation& violation) { said += violation.text + "\n"; });
    const auto image = loader::load_program(CAPSOC_PROGRAMS "/" + program + ".elf");
    if (!image) return image.error();
    for (const loader::Segment& segment : image.value().segments)
      if (const auto error = soc.load(program, segment.address, segment.bytes)) return error->text;
    soc.cpu.core().listeners().semihosting = [](armv7m::Core&) { return false; };
    sc_core::sc_start(sc_core::sc_time(300, sc_core::SC_MS));
    uint64_t seen = 0;
    for (const bus::MapEntry& entry : soc.ahb.map())
      for (uint64_t address = entry.base; address < entry.base + 0x100; address += 4)
        seen += soc.peek(static_cast<uint32_t>(address));
    if (monitor && soc.protocol.calls() < 500) said += "no calls\n";
    return said + fmt::format("{} cycles, {} instructions, registers {:#x}",
                              soc.cpu.core().cycles(), soc.cpu.core().instructions(), seen);
  });
}

TEST(Monitors, OfTheBoardSeeNothingWrongAndChangeNothing) {
  for (const char* program : {"hello", "drivers", "pins", "faults", "resets", "selfcal"})
    for (const auto executor : {armv7m::Executor::stepping, armv7m::Executor::translator})
      EXPECT_EQ(run(program, true, executor), run(program, false, executor)) << program;
}

TEST(Monitors, AreNotThereUnlessTheyAreAskedFor) {
  EXPECT_EQ(test::elsewhere([] {
              Soc soc("soc", {});
              return sc_core::sc_find_object("soc.icode_monitor") == nullptr ? "none" : "some";
            }),
            "none");
}

TEST(Loading, ASegmentWithoutBytesLiesNowhere) {
  EXPECT_EQ(test::elsewhere([] {
              Soc soc("soc", {});
              const auto error = soc.load("empty.elf", 0xFFFFFFF0, {});
              return error ? error->text : std::string("loaded");
            }),
            "loaded");
}

}  // namespace
}  // namespace capsoc::soc
