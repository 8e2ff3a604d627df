#include "own_soc.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

namespace {

TEST(OwnSoc, RunsAProgramOfItsOwn) {
  sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
  std::string text;
  own::OwnSoc soc("soc", [&text](char byte) { text += byte; });
  ASSERT_EQ(soc.ahb.error(), "");
  std::ifstream file(OWN_SOC_BIN, std::ios::binary);
  const std::string program{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  ASSERT_GT(program.size(), 68u);
  ASSERT_LT(program.size(), soc.ram.size());
  std::copy(program.begin(), program.end(), soc.ram.data());

  // Its state can be taken, too, and looking changes nothing.
  std::vector<uint64_t> hashes;
  const sc_core::sc_time step(1, sc_core::SC_MS);
  soc.cpu.set_pause(step, [&](const sc_core::sc_time& now) {
    capsoc::StateHash hash;
    hash("clock", soc.clock);
    for (capsoc::kit::Component* part : std::initializer_list<capsoc::kit::Component*>{
             &soc.cpu, &soc.ram, &soc.ticker, &soc.printer})
      part->visit_all(hash);
    hashes.push_back(hash.value());
    return now + step;
  });
  sc_core::sc_start();
  EXPECT_EQ(text, "tick\ntick\ntick\ntick\ntick\ndone\n");
  EXPECT_EQ(soc.cpu.end_reason(), capsoc::armv7m::EndReason::asleep);
  EXPECT_EQ(soc.cpu.core().cycles() / 50000, 5u);
  ASSERT_GE(hashes.size(), 4u);
  EXPECT_NE(hashes[0], hashes[1]);
}

}  // namespace

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
