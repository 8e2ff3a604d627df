// The board's own registers: FPGAIO and SCC. SystemC elaborates once: every test begins with a
// reset.
#include <gtest/gtest.h>

#include <memory>

#include "../bus/initiator.h"
#include "../kit/bench_main.h"
#include "an385/fpga_io.h"
#include "an385/scc.h"
#include "kit/guest_error.h"

namespace capsoc::test {
namespace {

struct Bench {
  Bench() {
    to_io.socket.bind(io.socket);
    to_scc.socket.bind(scc.socket);
  }
  an385::FpgaIo io{"fpgaio"};
  an385::Scc scc{"scc"};
  Initiator to_io{"to_io"}, to_scc{"to_scc"};
};
std::unique_ptr<Bench> the_bench;

constexpr double board_cycle_ns = 40;

void run_cycles(uint64_t n) {
  sc_core::sc_start(sc_core::sc_time(board_cycle_ns * static_cast<double>(n), sc_core::SC_NS));
}

class FpgaIoTest : public testing::Test {
 protected:
  enum Offset : uint64_t {
    led0 = 0x00,
    button = 0x08,
    clk1hz = 0x10,
    clk100hz = 0x14,
    counter = 0x18,
    prescale = 0x1c,
    pscntr = 0x20,
    misc = 0x4c,
  };
  FpgaIoTest() { b.io.reset(); }
  uint32_t get(uint64_t offset) { return b.to_io.read(offset).value; }
  void set(uint64_t offset, uint32_t v) { ASSERT_TRUE(b.to_io.write(offset, v).ok()); }
  Bench& b = *the_bench;
};

TEST_F(FpgaIoTest, ShowsItsTwoLedsToWhoeverWatches) {
  uint32_t seen = 0;
  const auto listening = b.io.leds.listen([&](uint32_t leds) { seen = leds; });
  set(led0, 0xfffffffe);
  EXPECT_EQ(get(led0), 2u);
  EXPECT_EQ(seen, 2u);
  b.io.reset();
  EXPECT_EQ(seen, 0u);
}

TEST_F(FpgaIoTest, ReadsTheButtonsAlsoAfterAReset) {
  b.io.set_buttons(2);
  b.io.reset();
  EXPECT_EQ(get(button), 2u);
  b.io.set_buttons(0);
  EXPECT_EQ(get(button), 0u);
}

TEST_F(FpgaIoTest, CountsSecondsAndHundredths) {
  // The counters run on whole units of simulated time, whenever they were reset.
  const uint32_t seconds = get(clk1hz), hundredths = get(clk100hz);
  sc_core::sc_start(3, sc_core::SC_SEC);
  EXPECT_EQ(get(clk1hz), seconds + 3);
  EXPECT_EQ(get(clk100hz), hundredths + 300);
  set(clk1hz, 1000);
  sc_core::sc_start(1, sc_core::SC_SEC);
  EXPECT_EQ(get(clk1hz), 1001u);
}

TEST_F(FpgaIoTest, CountsEveryCycleWithoutAPrescaler) {
  run_cycles(1000);
  EXPECT_EQ(get(counter), 1000u);
  set(counter, 5);
  run_cycles(10);
  EXPECT_EQ(get(counter), 15u);
}

TEST_F(FpgaIoTest, CountsTheReloadsOfItsPrescaler) {
  set(prescale, 5);
  set(pscntr, 7);
  set(counter, 0);
  // 7 6 5 4 3 2 1 0 5 4 3 2 1 0 5: the first reload in cycle 8, the second in cycle 14.
  for (uint32_t cycle = 1; cycle <= 14; ++cycle) {
    run_cycles(1);
    EXPECT_EQ(get(counter), cycle < 8 ? 0u : cycle < 14 ? 1u : 2u) << cycle;
    EXPECT_EQ(get(pscntr), cycle < 8 ? 7 - cycle : cycle < 14 ? 13 - cycle : 5u) << cycle;
  }
}

TEST_F(FpgaIoTest, KeepsOnlyTheLinesThatExistInMisc) {
  set(misc, 0xffffffff);
  EXPECT_EQ(get(misc), 0x3fbu);
}

class SccTest : public testing::Test {
 protected:
  enum Offset : uint64_t {
    cfg0 = 0x000,
    cfg1 = 0x004,
    cfg3 = 0x00c,
    cfg4 = 0x010,
    data_rtn = 0x0a0,
    data_out = 0x0a4,
    cfgctrl = 0x0a8,
    cfgstat = 0x0ac,
    dll = 0x100,
    aid = 0xff8,
    id = 0xffc,
  };
  SccTest() { b.scc.reset(); }
  uint32_t get(uint64_t offset) { return b.to_scc.read(offset).value; }
  void set(uint64_t offset, uint32_t v) { ASSERT_TRUE(b.to_scc.write(offset, v).ok()); }
  Bench& b = *the_bench;
};

TEST_F(SccTest, IdentifiesTheBoard) {
  EXPECT_EQ(get(id), 0x41043850u);
  EXPECT_EQ(get(aid), 0x00200008u);
  EXPECT_EQ(get(cfg4), 2u);
  EXPECT_EQ(get(dll), 0xffff0001u);
  EXPECT_EQ(get(cfgctrl), 0x00100000u);
}

TEST_F(SccTest, ReadsAndWritesAnOscillator) {
  set(cfgctrl, 0x80100001);
  EXPECT_EQ(get(cfgstat), 1u);
  EXPECT_EQ(get(data_rtn), 24'576'000u);
  set(data_out, 12'288'000);
  set(cfgctrl, 0xc0100001);
  EXPECT_EQ(get(cfgstat), 1u);
  set(cfgctrl, 0x80100001);
  EXPECT_EQ(get(data_rtn), 12'288'000u);
  EXPECT_EQ(get(cfgctrl), 0x00100001u);
}

TEST_F(SccTest, FailsATransferToWhatIsNotThere) {
  const uint64_t before = kit::guest_error_count("scc");
  set(cfgctrl, 0x80100003);
  EXPECT_EQ(get(cfgstat), 3u);
  set(cfgctrl, 0x80200000);
  EXPECT_EQ(get(cfgstat), 3u);
  set(cfgctrl, 0);
  EXPECT_EQ(get(cfgstat), 0u);
  EXPECT_EQ(kit::guest_error_count("scc"), before + 2);
}

TEST_F(SccTest, DrivesLedsAndReadsSwitches) {
  uint32_t seen = 0;
  const auto listening = b.scc.leds.listen([&](uint32_t leds) { seen = leds; });
  set(cfg1, 0x1a5);
  EXPECT_EQ(seen, 0xa5u);
  b.scc.set_switches(0x3c);
  EXPECT_EQ(get(cfg3), 0x3cu);
  b.scc.set_switches(0);
}

TEST_F(SccTest, ReportsARemapThatIsNotModelled) {
  const uint64_t before = kit::guest_error_count("scc");
  set(cfg0, 1);
  EXPECT_EQ(get(cfg0), 1u);
  EXPECT_EQ(kit::guest_error_count("scc"), before + 1);
}

TEST_F(SccTest, WritesOnlyTheMaskOfTheLockedLoops) {
  set(dll, 0);
  EXPECT_EQ(get(dll), 0x00ff0001u);
}

}  // namespace
}  // namespace capsoc::test

int sc_main(int argc, char** argv) {
  return capsoc::test::run_on_bench(argc, argv, capsoc::test::the_bench);
}
