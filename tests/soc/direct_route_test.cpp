// Accesses to devices without transactions (kit::DirectRoute) and with them: with a monitor between
// every two sockets no route is known.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "../elsewhere.h"
#include "soc/soc.h"

namespace capsoc::soc {
namespace {

using armv7m::AccessGate;
using armv7m::Executor;

constexpr uint32_t accesses_at = 0x60, stack_top = 0x20001000, hash_at = 0x20000200;

/// Pins, a counter and a UART in all widths, and flags across the accesses. Timer 0 interrupts
/// every 614 cycles; its handler hashes PC and xPSR of where it came.
const std::vector<uint16_t> accesses = {
    0x00EF, 0x0000,  // .word 0x000000ef
    0x4F28,          // ldr r7, [pc, #160]
    0xF04F, 0x4080,  // mov.w r0, #1073741824
    0xF240, 0x2165,  // movw r1, #613
    0x6081,          // str r1, [r0, #8]
    0x2109,          // movs r1, #9
    0x6001,          // str r1, [r0, #0]
    0x4825,          // ldr r0, [pc, #148]
    0xF44F, 0x7180,  // mov.w r1, #256
    0x6001,          // str r1, [r0, #0]
    0x4824,          // ldr r0, [pc, #144]
    0xF64F, 0x71FF,  // movw r1, #65535
    0x6101,          // str r1, [r0, #16]
    0xF04F, 0x2240,  // mov.w r2, #1073758208
    0x2110,          // movs r1, #16
    0x6111,          // str r1, [r2, #16]
    0x2101,          // movs r1, #1
    0x6091,          // str r1, [r2, #8]
    0x4920,          // ldr r1, [pc, #128]
    0xF06F, 0x0300,  // mvn.w r3, #0
    0x608B,          // str r3, [r1, #8]
    0x2301,          // movs r3, #1
    0x600B,          // str r3, [r1, #0]
    0x2500,          // movs r5, #0
    0x2600,          // movs r6, #0
    0xF04F, 0x0804,  // mov.w r8, #4
    0xF44F, 0x797A,  // mov.w r9, #1000
    0x6045,          // loop: str r5, [r0, #4]
    0x684B,          // ldr r3, [r1, #4]
    0x18F6,          // adds r6, r6, r3
    0x7106,          // strb r6, [r0, #4]
    0x7804,          // ldrb r4, [r0, #0]
    0x4166,          // adcs r6, r4
    0x888B,          // ldrh r3, [r1, #4]
    0xF991, 0x4004,  // ldrsb.w r4, [r1, #4]
    0x4066,          // eors r6, r4
    0x8085,          // strh r5, [r0, #4]
    0x6853,          // ldr r3, [r2, #4]
    0x07DB,          // lsls r3, r3, #31
    0xD400,          // bmi.n c6
    0x7015,          // strb r5, [r2, #0]
    0xF851, 0x3008,  // ldr.w r3, [r1, r8]
    0x42AB,          // cmp r3, r5
    0xBF88,          // it hi
    0x3601,          // addhi r6, #1
    0xBF28,          // it cs
    0x6045,          // strcs r5, [r0, #4]
    0xF931, 0x3008,  // ldrsh.w r3, [r1, r8]
    0x684C,          // ldr r4, [r1, #4]
    0x419E,          // sbcs r6, r3
    0xEB05, 0x0585,  // add.w r5, r5, r5, lsl #2
    0x3501,          // adds r5, #1
    0xB2AD,          // uxth r5, r5
    0xF1B9, 0x0901,  // subs.w r9, r9, #1
    0x6045,          // str r5, [r0, #4]
    0xD1DD,          // bne.n a8
    0xBEAB,          // bkpt 0x00ab
    0xF04F, 0x4080,  // handler: mov.w r0, #1073741824
    0x2101,          // movs r1, #1
    0x60C1,          // str r1, [r0, #12]
    0x683A,          // ldr r2, [r7, #0]
    0xEBC2, 0x1242,  // rsb r2, r2, r2, lsl #5
    0x9907,          // ldr r1, [sp, #28]
    0x440A,          // add r2, r1
    0x9906,          // ldr r1, [sp, #24]
    0x404A,          // eors r2, r1
    0x603A,          // str r2, [r7, #0]
    0x4770,          // bx lr
    0x0200, 0x2000,  // .word 0x20000200
    0xE100, 0xE000,  // .word 0xe000e100
    0x0000, 0x4001,  // .word 0x40010000
    0x1000, 0x4000,  // .word 0x40001000
};

/// What is done to a board before it runs, and what is said of it afterwards.
using Watcher = std::function<std::function<std::string()>(Soc&)>;

struct Way {
  bool monitor = false;
  Executor executor = Executor::translator;
  double quantum_us = 1000;
};

std::string run(const Way& way, const Watcher& watcher) {
  return test::elsewhere([&] {
    sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
    Config config;
    config.monitor = way.monitor;
    config.executor = way.executor;
    config.quantum = sc_core::sc_time(way.quantum_us, sc_core::SC_US);
    config.translator.warm_up = 0;
    config.translator.threshold = 3;
    Soc soc("soc", config);
    const uint32_t vectors[] = {stack_top, 0x65};
    soc.write_memory(0, vectors, sizeof vectors);
    soc.write_memory(accesses_at, accesses.data(), static_cast<uint32_t>(2 * accesses.size()));
    std::string sent;
    const kit::Listening uart = soc.uart0.transmitted.listen([&](uint8_t byte) {
      sent += fmt::format(" {:02x}@{}", byte, sc_core::sc_time_stamp().value());
    });
    soc.cpu.core().listeners().semihosting = [](armv7m::Core&) { return false; };
    const std::function<std::string()> seen = watcher ? watcher(soc) : nullptr;
    sc_core::sc_start(sc_core::sc_time(20, sc_core::SC_MS));
    const armv7m::Core& core = soc.cpu.core();
    std::string said =
        fmt::format("end {} at cycle {}, {} instructions", static_cast<int>(soc.cpu.end_reason()),
                    core.cycles(), core.instructions());
    for (unsigned n = 0; n < 16; ++n) said += fmt::format(" {:x}", core.reg(n));
    uint32_t words[2] = {};
    soc.read_memory(hash_at, words, sizeof words);
    return said +
           fmt::format(" memory {:x} {:x} pins {:x}\n", words[0], words[1], soc.gpio0.pins()) +
           sent + "\n" + (seen ? seen() : "");
  });
}

/// All ways to run give what stepping with transactions gives.
void expect_all_same(const Watcher& watcher, const std::string& part) {
  const std::string expected = run({true, Executor::stepping}, watcher);
  EXPECT_NE(expected.find(part), std::string::npos) << expected;
  for (const Executor executor : {Executor::stepping, Executor::blocks, Executor::translator})
    for (const double quantum_us : {1000.0, 3.0})
      EXPECT_EQ(run({false, executor, quantum_us}, watcher), expected)
          << static_cast<int>(executor) << ", " << quantum_us;
}

TEST(DirectRoutes, ChangeNothing) {
  expect_all_same(nullptr, "end 1 at cycle");
}

/// Listens to the transfers of the bus for a while in the middle.
std::function<std::string()> listen(Soc& soc) {
  struct Seen {
    kit::Listening listening;
    std::string text;
  };
  const auto seen = std::make_shared<Seen>();
  sc_core::sc_spawn([&soc, seen] {
    sc_core::wait(sc_core::sc_time(301, sc_core::SC_US));
    seen->listening = soc.ahb.transfers.listen([seen](const tlm::tlm_generic_payload& payload,
                                                      const sc_core::sc_time& begin,
                                                      const sc_core::sc_time& end) {
      uint32_t value = 0;
      std::memcpy(&value, payload.get_data_ptr(), payload.get_data_length());
      const sc_core::sc_time now = sc_core::sc_time_stamp();
      seen->text += fmt::format("{} {} {:x} {:x}\n", (now + begin).value(), (now + end).value(),
                                payload.get_address(), value);
    });
    sc_core::wait(sc_core::sc_time(400, sc_core::SC_US));
    seen->listening = {};
  });
  return [seen] { return seen->text; };
}

TEST(DirectRoutes, LetAListenerSeeEveryTransfer) {
  expect_all_same(listen, "40010004");
}

/// Changes, loses and, if wanted, fails accesses for a while in the middle.
class Gate : public AccessGate {
 public:
  explicit Gate(bool fails) : fails_(fails) {}
  std::string text;

 private:
  Fate sent(const Access& access, uint32_t& value) override {
    text += fmt::format("{:x} {} {} {:x} at {}\n", access.address, access.size, access.is_store,
                        access.is_store ? value : 0, sc_core::sc_time_stamp().value());
    ++count_;
    if (access.is_store && count_ % 7 == 0) value ^= 1;
    if (fails_ && count_ == 50) return Fate::fails;
    return access.is_store && count_ % 5 == 0 ? Fate::lost : Fate::arrives;
  }
  void returned(const Access&, uint32_t& value) override {
    if (count_ % 3 == 0) value ^= 4;
  }

  bool fails_;
  unsigned count_ = 0;
};

template <bool fails>
std::function<std::string()> gate(Soc& soc) {
  const auto gate = std::make_shared<Gate>(fails);
  const sc_core::sc_time begin(251, sc_core::SC_US), end(401, sc_core::SC_US);
  soc.cpu.set_pause(begin, [&soc, gate, end](const sc_core::sc_time& now) {
    soc.cpu.set_access_gate(now < end ? gate.get() : nullptr);
    return now < end ? end : sc_core::sc_max_time();
  });
  return [gate] { return gate->text; };
}

TEST(DirectRoutes, LetAGateChangeEveryAccess) {
  expect_all_same(gate<false>, "40010004 1 true");
}

TEST(DirectRoutes, LetAGateFailAnAccess) {
  expect_all_same(gate<true>, "40010004 1 true");
}

/// In place of the loop the program leaves for memory that is not modelled, and runs through 128
/// KiB of its zeros to a breakpoint after them.
std::function<std::string()> leave_code(Soc& soc) {
  constexpr uint32_t loop_at = 0xA8, end = 0x01000000;
  const uint16_t jump[] = {
      0xF240, 0x0101,  // movw r1, #1
      0xF2C0, 0x01FE,  // movt r1, #254
      0x4708,          // bx r1
  };
  const uint16_t breakpoint = 0xBEAB;
  soc.write_memory(loop_at, jump, sizeof jump);
  soc.write_memory(end, &breakpoint, sizeof breakpoint);
  return [&soc] {
    uint64_t count = 0;
    for (const auto& device : soc.unimplemented) count += device->accesses();
    return fmt::format("{} accesses", count);
  };
}

TEST(DirectRoutes, CodeOfZerosRunsTheSame) {
  expect_all_same(leave_code, "65536 accesses");
}

TEST(DirectRoutes, CodeOfZerosIsFetchedWhereAListenerSeesIt) {
  const auto both = [](Soc& soc) {
    const auto count = leave_code(soc), seen = listen(soc);
    return [count, seen] { return count() + "\n" + seen(); };
  };
  expect_all_same(both, " fe4000 0");
}

/// An observer of the pins for a while: writes to them are made at their time then.
std::function<std::string()> look_at_pins(Soc& soc) {
  struct Seen {
    kit::Listening listening;
    std::string text;
  };
  const auto seen = std::make_shared<Seen>();
  sc_core::sc_spawn([&soc, seen] {
    sc_core::wait(sc_core::sc_time(301, sc_core::SC_US));
    seen->listening = soc.gpio0.outputs.listen([seen](uint16_t levels, uint16_t driven) {
      seen->text += fmt::format("{} {:x} {:x}\n", sc_core::sc_time_stamp().value(), levels, driven);
    });
    sc_core::wait(sc_core::sc_time(200, sc_core::SC_US));
    seen->listening = {};
  });
  return [seen] { return seen->text; };
}

TEST(DirectRoutes, LetAnObserverOfTheDeviceSeeEveryChange) {
  expect_all_same(look_at_pins, " ffff\n");
}

/// Other frequencies, of which the first has no whole number of picoseconds as its period.
std::function<std::string()> change_clock(Soc& soc) {
  sc_core::sc_spawn([&soc] {
    for (const uint64_t hz : {7'000'003, 24'000'000, 50'000'000}) {
      sc_core::wait(sc_core::sc_time(157, sc_core::SC_US));
      soc.clock.set_frequency(hz);
    }
  });
  return [] { return std::string(); };
}

TEST(DirectRoutes, FollowTheClock) {
  expect_all_same(change_clock, "end 1 at cycle");
}

/// Sends a read of a word as the processor does. Returns what was described of its way.
kit::DirectRoute described(Soc& soc, uint64_t address, uint64_t& cycles) {
  kit::DirectRoute route;
  uint8_t bytes[4] = {};
  tlm::tlm_generic_payload payload;
  payload.set_read();
  payload.set_address(address);
  payload.set_data_ptr(bytes);
  payload.set_data_length(4);
  payload.set_streaming_width(4);
  payload.set_extension(&route);
  sc_core::sc_time delay;
  soc.cpu.system->b_transport(payload, delay);
  payload.clear_extension<kit::DirectRoute>();
  cycles = soc.clock.cycles_at(delay);
  return route;
}

/// The entries of the map whose first register can be reached directly, and what it takes.
std::string directly_reached(bool monitor, bool watched) {
  return test::elsewhere([&] {
    sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
    Config config;
    config.monitor = monitor;
    Soc soc("soc", config);
    soc.cpu.resume_at(sc_core::sc_time(1, sc_core::SC_SEC), [] { return false; });
    sc_core::sc_start(sc_core::sc_time(1, sc_core::SC_US));
    kit::Listening listening;
    if (watched)
      listening = soc.ahb.transfers.listen(
          [](const tlm::tlm_generic_payload&, const sc_core::sc_time&, const sc_core::sc_time&) {});
    std::string said;
    for (const bus::MapEntry& entry : soc.ahb.map()) {
      if (entry.kind != bus::TargetKind::device) continue;
      uint64_t cycles = 0;
      const kit::DirectRoute route = described(soc, entry.base, cycles);
      if (!route.is_whole(soc.cpu.system.operator->())) continue;
      said += fmt::format("{} {}{}\n", entry.name, route.cycles, route.cycles == cycles ? "" : "?");
    }
    return said;
  });
}

TEST(DirectRoutes, AreDescribedWithTheTimeThatTheyTake) {
  const std::string all = directly_reached(false, false);
  EXPECT_NE(all.find("gpio0 0\n"), std::string::npos) << all;
  EXPECT_NE(all.find("timer0 2\n"), std::string::npos) << all;
  EXPECT_NE(all.find("uart4 2\n"), std::string::npos) << all;
  EXPECT_EQ(all.find('?'), std::string::npos) << all;
  EXPECT_EQ(all.find("coprocessor"), std::string::npos) << "which has more than registers" << all;
}

TEST(DirectRoutes, AreNotDescribedWhereSomebodyIsOnTheWay) {
  EXPECT_EQ(directly_reached(true, false), "");
  EXPECT_EQ(directly_reached(false, true), "");
}

}  // namespace
}  // namespace capsoc::soc
