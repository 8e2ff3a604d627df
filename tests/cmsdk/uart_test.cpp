#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench.h"
#include "kit/early_write.h"

namespace capsoc::test {
namespace {

using cmsdk::Uart;

enum Offset : uint64_t { data = 0x0, state = 0x4, ctrl = 0x8, intstatus = 0xc, bauddiv = 0x10 };

constexpr uint32_t divider = 217;  // 115,207 baud at 25 MHz
constexpr uint64_t byte_time = 10 * divider;

class UartTest : public testing::Test {
 protected:
  UartTest() {
    b.clock.set_frequency(25'000'000);
    // Whatever an earlier test left at the far end is heard and forgotten.
    uart.reset();
    set(bauddiv, 16);
    set(ctrl, Uart::ctrl_rx_enable);
    b.run(16 * 10 * 8);
    uart.reset();
    sent.clear();
    listening_ = uart.transmitted.listen([this](uint8_t byte) {
      sent.push_back({b.cycle(), byte});
    });
  }
  ~UartTest() override { uart.set_source({}); }

  uint32_t get(uint64_t offset) { return b.to_uart.read(offset).value; }
  void set(uint64_t offset, uint32_t value) { ASSERT_TRUE(b.to_uart.write(offset, value).ok()); }
  void enable(uint32_t bits) {
    set(bauddiv, divider);
    set(ctrl, bits);
  }
  uint64_t errors() const { return kit::guest_error_count("uart"); }

  Bench& b = bench();
  Uart& uart = b.uart;
  std::vector<std::pair<uint64_t, uint8_t>> sent;
  kit::Listening listening_;
};

TEST_F(UartTest, HasItsRegistersAtZeroAfterReset) {
  for (uint64_t offset : {data, state, ctrl, intstatus, bauddiv}) EXPECT_EQ(get(offset), 0u);
}

TEST_F(UartTest, KeepsOnlyTheBitsThatExist) {
  set(ctrl, 0xffffffff);
  EXPECT_EQ(get(ctrl), 0x7fu);
  set(bauddiv, 0xffffffff);
  EXPECT_EQ(get(bauddiv), 0xfffffu);
}

TEST_F(UartTest, ReportsReservedBits) {
  const uint64_t before = errors();
  set(bauddiv, 0x100010);
  EXPECT_EQ(errors(), before + 1);
}

TEST_F(UartTest, SendsAByteInExactlyTenBitTimes) {
  enable(Uart::ctrl_tx_enable);
  const uint64_t start = b.cycle();
  set(data, 'A');
  b.run(byte_time - 1);
  EXPECT_TRUE(sent.empty());
  b.run(1);
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(sent[0], std::make_pair(start + byte_time, uint8_t{'A'}));
}

TEST_F(UartTest, SendsTwoBytesWithoutAGap) {
  enable(Uart::ctrl_tx_enable);
  const uint64_t start = b.cycle();
  set(data, 'A');
  b.run(100);
  set(data, 'B');
  b.run(3 * byte_time);
  ASSERT_EQ(sent.size(), 2u);
  EXPECT_EQ(sent[1], std::make_pair(start + 2 * byte_time, uint8_t{'B'}));
  EXPECT_TRUE(uart.transmitter_idle());
}

TEST_F(UartTest, IsFullWhileTheShifterIsBusyAndTheBufferTaken) {
  enable(Uart::ctrl_tx_enable);
  set(data, 'A');
  EXPECT_EQ(get(state), 0u);
  set(data, 'B');
  EXPECT_EQ(get(state), Uart::state_tx_full);
  b.run(byte_time);
  EXPECT_EQ(get(state), 0u);
  EXPECT_FALSE(uart.transmitter_idle());
}

TEST_F(UartTest, EveryByteThatATransmitOverrunLosesIsReported) {
  const auto lost = [] { return kit::guest_error_count("uart (transmit overrun)"); };
  const uint64_t before = lost();
  enable(Uart::ctrl_tx_enable);
  set(data, 1);  // to the shifter
  set(data, 2);  // to the buffer
  EXPECT_EQ(lost(), before);
  set(data, 3);
  set(data, 4);
  EXPECT_EQ(lost(), before + 2);
}

TEST_F(UartTest, AnOverrunLosesTheOlderByteAndSticksUntilOneIsWritten) {
  enable(Uart::ctrl_tx_enable);
  for (char c : std::string("ABC")) set(data, static_cast<uint8_t>(c));
  EXPECT_EQ(get(state), Uart::state_tx_full | Uart::state_tx_overrun);
  set(state, Uart::state_tx_full | Uart::state_rx_overrun);
  EXPECT_EQ(get(state), Uart::state_tx_full | Uart::state_tx_overrun);
  set(state, Uart::state_tx_overrun);
  EXPECT_EQ(get(state), Uart::state_tx_full);
  b.run(3 * byte_time);
  ASSERT_EQ(sent.size(), 2u);
  EXPECT_EQ(sent[1].second, 'C');
}

TEST_F(UartTest, InterruptsWhenTheTransmitBufferRunsEmpty) {
  enable(Uart::ctrl_tx_enable | Uart::ctrl_tx_interrupt);
  set(data, 'A');
  EXPECT_TRUE(uart.tx_interrupt.level());
  EXPECT_TRUE(uart.combined_interrupt.level());
  set(intstatus, Uart::interrupt_tx);
  EXPECT_FALSE(uart.tx_interrupt.level());
  set(data, 'B');
  b.run(byte_time - 1);
  EXPECT_FALSE(uart.tx_interrupt.level());
  b.run(1);
  EXPECT_TRUE(uart.tx_interrupt.level());
  EXPECT_EQ(get(intstatus), Uart::interrupt_tx);
  EXPECT_FALSE(uart.rx_interrupt.level());
  EXPECT_FALSE(uart.overrun_interrupt.level());
}

TEST_F(UartTest, HoldsTheByteUntilTheTransmitterIsEnabled) {
  set(bauddiv, divider);
  set(data, 'A');
  b.run(2 * byte_time);
  EXPECT_EQ(get(state), Uart::state_tx_full);
  set(ctrl, Uart::ctrl_tx_enable);
  b.run(byte_time);
  EXPECT_EQ(sent.size(), 1u);
}

TEST_F(UartTest, FinishesTheByteOnTheLineWhenDisabledAndKeepsTheNext) {
  enable(Uart::ctrl_tx_enable);
  set(data, 'A');
  set(data, 'B');
  b.run(10);
  set(ctrl, 0);
  b.run(3 * byte_time);
  EXPECT_EQ(sent.size(), 1u);
  EXPECT_EQ(get(state), Uart::state_tx_full);
}

TEST_F(UartTest, HasNoBaudRateBelowSixteenAndTellsTheGuest) {
  const uint64_t before = errors();
  set(bauddiv, 15);
  EXPECT_EQ(errors(), before);
  set(ctrl, Uart::ctrl_tx_enable);
  EXPECT_EQ(errors(), before + 1);
  set(data, 'A');
  b.run(1000);
  EXPECT_TRUE(sent.empty());
  set(bauddiv, 16);
  b.run(160);
  EXPECT_EQ(sent.size(), 1u);
}

TEST_F(UartTest, SendsOneBitACycleInHighSpeedTestMode) {
  set(ctrl, Uart::ctrl_tx_enable | Uart::ctrl_high_speed_test);
  set(data, 'A');
  b.run(9);
  EXPECT_TRUE(sent.empty());
  b.run(1);
  EXPECT_EQ(sent.size(), 1u);
}

TEST_F(UartTest, LetsAByteUnderWayKeepItsRate) {
  enable(Uart::ctrl_tx_enable);
  const uint64_t start = b.cycle();
  set(data, 'A');
  set(data, 'B');
  b.run(100);
  set(bauddiv, 16);
  b.run(2 * byte_time);
  ASSERT_EQ(sent.size(), 2u);
  EXPECT_EQ(sent[0].first, start + byte_time);
  EXPECT_EQ(sent[1].first, start + byte_time + 160);
}

TEST_F(UartTest, KeepsItsCycleWhenTheClockChanges) {
  enable(Uart::ctrl_tx_enable);
  const uint64_t start = b.cycle();
  set(data, 'A');
  b.run(1000);
  const sc_core::sc_time changed = sc_core::sc_time_stamp();
  b.clock.set_frequency(100'000'000);
  b.run(byte_time - 1000);
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(sent[0].first, start + byte_time);
  EXPECT_EQ(sc_core::sc_time_stamp() - changed,
            sc_core::sc_time(10, sc_core::SC_NS) * static_cast<double>(byte_time - 1000));
}

TEST_F(UartTest, ReceivesAByteAfterTenBitTimes) {
  enable(Uart::ctrl_rx_enable);
  uart.receive('x');
  b.run(byte_time - 1);
  EXPECT_EQ(get(state), 0u);
  b.run(1);
  EXPECT_EQ(get(state), Uart::state_rx_full);
  EXPECT_EQ(get(data), uint32_t{'x'});
  EXPECT_EQ(get(state), 0u);
  EXPECT_EQ(get(data), uint32_t{'x'});
}

TEST_F(UartTest, InterruptsOnReceptionUntilCleared) {
  enable(Uart::ctrl_rx_enable | Uart::ctrl_rx_interrupt);
  uart.receive('x');
  b.run(byte_time);
  EXPECT_TRUE(uart.rx_interrupt.level());
  EXPECT_TRUE(uart.combined_interrupt.level());
  EXPECT_FALSE(uart.tx_interrupt.level());
  get(data);
  EXPECT_TRUE(uart.rx_interrupt.level());
  EXPECT_EQ(get(intstatus), Uart::interrupt_rx);
  set(intstatus, Uart::interrupt_rx);
  EXPECT_FALSE(uart.rx_interrupt.level());
}

TEST_F(UartTest, AReceiveOverrunKeepsTheNewerByteAndInterrupts) {
  enable(Uart::ctrl_rx_enable | Uart::ctrl_rx_overrun_interrupt);
  uart.receive('x');
  uart.receive('y');
  b.run(2 * byte_time);
  EXPECT_EQ(get(state), Uart::state_rx_full | Uart::state_rx_overrun);
  EXPECT_EQ(get(intstatus), Uart::interrupt_rx_overrun);
  EXPECT_TRUE(uart.overrun_interrupt.level());
  EXPECT_EQ(get(data), uint32_t{'y'});
  set(intstatus, Uart::interrupt_rx_overrun);
  EXPECT_EQ(get(state), 0u);
  EXPECT_FALSE(uart.overrun_interrupt.level());
}

TEST_F(UartTest, TheOverrunInterruptsFollowStateAndTheirEnables) {
  enable(Uart::ctrl_tx_enable);
  for (int i = 0; i < 3; ++i) set(data, 'A');
  EXPECT_FALSE(uart.overrun_interrupt.level());
  set(ctrl, Uart::ctrl_tx_enable | Uart::ctrl_tx_overrun_interrupt);
  EXPECT_EQ(get(intstatus), Uart::interrupt_tx_overrun);
  EXPECT_TRUE(uart.overrun_interrupt.level());
  EXPECT_TRUE(uart.combined_interrupt.level());
  set(state, Uart::state_tx_overrun);
  EXPECT_EQ(get(intstatus), 0u);
  EXPECT_FALSE(uart.overrun_interrupt.level());
}

TEST_F(UartTest, TheFarEndWaitsForTheReceiver) {
  uart.receive('x');
  b.run(byte_time);
  EXPECT_EQ(get(state), 0u);
  enable(Uart::ctrl_rx_enable);
  b.run(byte_time);
  EXPECT_EQ(get(data), uint32_t{'x'});
}

TEST_F(UartTest, LosesAByteWhoseReceiverIsDisabledHalfWay) {
  enable(Uart::ctrl_rx_enable);
  uart.receive('x');
  b.run(100);
  set(ctrl, 0);
  b.run(byte_time);
  EXPECT_EQ(get(state), 0u);
  EXPECT_EQ(get(data), 0u);
}

TEST_F(UartTest, SendsAndReceivesAtTheSameTime) {
  enable(Uart::ctrl_tx_enable | Uart::ctrl_rx_enable);
  set(data, 'A');
  uart.receive('x');
  b.run(byte_time);
  EXPECT_EQ(sent.size(), 1u);
  EXPECT_EQ(get(data), uint32_t{'x'});
}

TEST_F(UartTest, ADebuggerReadsDataWithoutTakingIt) {
  enable(Uart::ctrl_rx_enable);
  uart.receive('x');
  b.run(byte_time);
  EXPECT_EQ(b.to_uart.debug_read(data), uint32_t{'x'});
  EXPECT_EQ(b.to_uart.debug_read(state), Uart::state_rx_full);
  EXPECT_EQ(get(state), Uart::state_rx_full);
}

TEST_F(UartTest, ASourceWaitsForTheProgram) {
  std::string text = "abc";
  uart.set_source([&]() -> std::optional<uint8_t> {
    if (text.empty()) return std::nullopt;
    const auto byte = static_cast<uint8_t>(text[0]);
    text.erase(0, 1);
    return byte;
  });
  b.run(byte_time);
  EXPECT_EQ(text, "abc") << "nobody listens";
  enable(Uart::ctrl_rx_enable);
  b.run(byte_time - 1);
  EXPECT_EQ(get(state), 0U);
  b.run(1);
  EXPECT_EQ(get(state), Uart::state_rx_full);
  b.run(10 * byte_time);
  EXPECT_EQ(text, "bc") << "the buffer is full";
  EXPECT_EQ(get(data), uint32_t{'a'});
  b.run(byte_time - 1);
  EXPECT_EQ(get(state), 0U);
  b.run(1);
  EXPECT_EQ(get(data), uint32_t{'b'});
  b.run(byte_time);
  EXPECT_EQ(get(data), uint32_t{'c'});
  b.run(3 * byte_time);
  EXPECT_EQ(get(state), 0U) << "no overrun, nothing left";
  text = "d";
  b.run(3 * byte_time);
  EXPECT_EQ(get(state), 0U) << "it does not ask by itself";
  uart.look_for_input();
  b.run(byte_time);
  EXPECT_EQ(get(data), uint32_t{'d'});
}

TEST_F(UartTest, TakesAByteWriteToItsLowByteOnly) {
  enable(Uart::ctrl_tx_enable);
  EXPECT_TRUE(b.to_uart.write(data, 'A', 1).ok());
  EXPECT_TRUE(b.to_uart.write(data + 1, 'B', 1).ok());
  b.run(3 * byte_time);
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(sent[0].second, 'A');
}

TEST_F(UartTest, HonoursADelayThatAnInitiatorHasAlreadySpent) {
  enable(Uart::ctrl_tx_enable);
  const uint64_t start = b.cycle();
  unsigned char bytes[4] = {'A'};
  tlm::tlm_generic_payload payload;
  Initiator::describe(payload, tlm::TLM_WRITE_COMMAND, data, bytes, 4);
  b.to_uart.send(payload, sc_core::sc_time(400, sc_core::SC_NS));
  b.run(byte_time + 10);
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(sent[0].first, start + 10 + byte_time);
}

TEST_F(UartTest, FlushesTheShifterThenTheBuffer) {
  enable(Uart::ctrl_tx_enable);
  set(data, 'A');
  set(data, 'B');
  uart.flush();
  ASSERT_EQ(sent.size(), 2u);
  EXPECT_EQ(sent[0].second, 'A');
  EXPECT_TRUE(uart.transmitter_idle());
  b.run(3 * byte_time);
  EXPECT_EQ(sent.size(), 2u);
}

TEST_F(UartTest, AResetDropsWhatIsOnTheLineAndLowersTheInterrupts) {
  enable(0x7f & ~Uart::ctrl_high_speed_test);
  set(data, 'A');
  uart.receive('x');
  uart.reset();
  EXPECT_FALSE(uart.combined_interrupt.level());
  EXPECT_EQ(get(bauddiv), 0u);
  enable(Uart::ctrl_tx_enable | Uart::ctrl_rx_enable);
  b.run(2 * byte_time);
  EXPECT_TRUE(sent.empty());
  EXPECT_EQ(get(state), 0u);
}

/// A write to DATA, `cycles` ahead of the kernel.
class EarlyUartWrite : public UartTest {
 protected:
  /// Whether it was taken.
  bool write_early(uint32_t value, uint64_t cycles, uint64_t offset = data, unsigned length = 4) {
    tlm::tlm_generic_payload payload;
    Initiator::describe(payload, tlm::TLM_WRITE_COMMAND, offset,
                        reinterpret_cast<unsigned char*>(&value), length);
    kit::EarlyWrite told;
    told.early = true;
    payload.set_extension(&told);
    const sc_core::sc_time lead = b.clock.time_of(b.cycle() + cycles) - b.clock.time_of(b.cycle());
    EXPECT_TRUE(b.to_uart.send(payload, lead).ok());
    payload.clear_extension<kit::EarlyWrite>();
    EXPECT_NE(told.taken, told.refused());
    return told.taken;
  }
};

TEST_F(EarlyUartWrite, SendsAtItsOwnTime) {
  enable(Uart::ctrl_tx_enable);
  const uint64_t start = b.cycle();
  EXPECT_TRUE(write_early('A', 7));
  EXPECT_TRUE(write_early('B', 9)) << "the first is in the shifter";
  b.run(2 * byte_time + 20);
  const std::vector<std::pair<uint64_t, uint8_t>> both = {{start + 7 + byte_time, 'A'},
                                                          {start + 7 + 2 * byte_time, 'B'}};
  EXPECT_EQ(sent, both);
}

TEST_F(EarlyUartWrite, DoesNothingWhereItWouldBeNoticedAtOnce) {
  const uint64_t before = errors();
  enable(Uart::ctrl_tx_enable | Uart::ctrl_tx_interrupt);
  EXPECT_FALSE(write_early('A', 7)) << "the empty buffer is an interrupt";
  EXPECT_EQ(get(intstatus), 0u);
  enable(Uart::ctrl_tx_enable);
  EXPECT_FALSE(write_early(0x141, 7)) << "a reserved bit is reported";
  EXPECT_FALSE(write_early(0, 7, data + 1, 1)) << "a byte that sends nothing is reported";
  EXPECT_FALSE(write_early(Uart::ctrl_tx_enable, 7, ctrl));
  set(data, 'X');
  set(data, 'Y');
  EXPECT_FALSE(write_early('Z', 7)) << "an overrun is reported";
  EXPECT_EQ(get(state), Uart::state_tx_full);
  EXPECT_EQ(errors(), before);
  b.run(3 * byte_time);
  ASSERT_EQ(sent.size(), 2u);
  EXPECT_EQ(sent[0].second, 'X');
  EXPECT_EQ(sent[1].second, 'Y');
}

}  // namespace
}  // namespace capsoc::test
