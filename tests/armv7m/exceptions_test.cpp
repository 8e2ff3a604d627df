#include <gtest/gtest.h>

#include <utility>

#include "bench.h"
#include "executors.h"

namespace capsoc::armv7m::test {

// B1.5.6
TEST(Exceptions, AnInterruptRaisedByAStoreIsTakenRightAfterIt) {
  Bench b;
  b.on_write = [&](uint32_t) { b.core.set_interrupt(5, true); };
  uint32_t nvic = 0xE000E100;
  // enable line 5 through the register: str r5,[r4]; then the store
  b.start({0x6025, 0x6001, 0x2301, 0xE7FE});
  b.core.set_reg(4, nvic);
  b.core.set_reg(5, 1u << 5);
  b.core.set_reg(0, 0x40000000);
  b.core.run(5);
  EXPECT_EQ(b.core.state().xpsr() & 0x1FF, 21u);
  EXPECT_EQ(b.core.reg(3), 0u);
  EXPECT_EQ(b.peek(b.core.state().msp() + 24), Bench::program + 4);
}

// B1.5.6
TEST(Exceptions, SvcStacksTheNextAddressAndReturnsThere) {
  Bench b;
  b.start({0xDF00, 0x2301, 0xE7FE});
  b.core.run(5);
  EXPECT_EQ(b.core.state().xpsr() & 0x1FF, 11u);
  EXPECT_EQ(b.core.reg(14), 0xFFFFFFF9u);
  b.core.run(40);
  EXPECT_EQ(b.core.reg(3), 1u);
  EXPECT_EQ(b.core.reg(13), Bench::stack);
}

// B1.5.7
TEST(Exceptions, TheStackIsAlignedToEightAndRestored) {
  Bench b;
  b.start({0xB082 - 1, 0xDF00, 0xE7FE});  // sub sp,#4; svc
  b.core.run(6);
  EXPECT_EQ(b.core.state().msp() & 7, 0u);
  EXPECT_NE(b.peek(b.core.state().msp() + 28) & 1u << 9, 0u);
  b.core.run(40);
  EXPECT_EQ(b.core.reg(13), Bench::stack - 4);
}

// B1.5.4
TEST(Exceptions, ADisabledUsageFaultEscalatesToHardFault) {
  Bench b;
  b.start({0xDE00});
  b.core.run(5);
  EXPECT_EQ(b.core.state().xpsr() & 0x1FF, 3u);
  EXPECT_EQ(b.core.last_fault().kind, FaultReport::Kind::hard_fault);
  EXPECT_EQ(b.core.last_fault().hfsr, 1u << 30);
  EXPECT_EQ(b.core.last_fault().frame[6], Bench::program);
  EXPECT_NE(describe_cfsr(1u << 16, 0).find("undefined instruction"), std::string::npos);
}

TEST(Exceptions, AnSvcThatItsPriorityDoesNotLetThroughEscalatesAndLeavesNoStatus) {
  Bench b;
  b.start({0xB672, 0xDF00});  // cpsid i; svc
  b.core.run(8);
  EXPECT_EQ(b.core.state().xpsr() & 0x1FF, 3u);
  const FaultReport& report = b.core.last_fault();
  EXPECT_EQ(report.hfsr, 1u << 30);
  EXPECT_EQ(report.cfsr, 0u);
  EXPECT_EQ(describe_cfsr(report.cfsr, report.hfsr),
            "FORCED: escalated from an SVC that could not be taken");
  EXPECT_NE(describe_cfsr(1u << 16, report.hfsr).find("escalated from a fault"), std::string::npos);
}

// B1.5.15
TEST(Exceptions, AFaultInHardFaultLocksUpAndAnNmiLeadsOut) {
  Bench b;
  b.code(0x4000 + 32 * 3, {0xDE00});
  b.start({0xDE00});
  EXPECT_EQ(b.core.run(100), StopReason::lockup);
  EXPECT_EQ(b.core.last_fault().kind, FaultReport::Kind::lockup);
  EXPECT_EQ(b.core.reg(15), 0xFFFFFFFEu);
  b.core.pulse_nmi();
  b.core.run(b.core.cycles() + 1);
  EXPECT_EQ(b.core.state().xpsr() & 0x1FF, 2u);
}

// C1.6.1
TEST(Exceptions, BreakpointsWithoutADebuggerAreHardFaults) {
  Bench b;
  b.start({0xBE00});
  b.core.run(5);
  EXPECT_EQ(b.core.last_fault().hfsr >> 31, 1u);
}

// B1.4.2
// A2.3.1: INVSTATE is the next instruction's, so that has to be fetched first (B3.2.15).
TEST(Exceptions, WhatCannotBeFetchedFaultsSoAtAnEvenAddress) {
  constexpr uint32_t iaccviol = 1, ibuserr = 1U << 8, invstate = 1U << 17;
  for (const Executor executor : all_executors)
    for (const auto& [target, cfsr] : {std::pair{0x40000000U, iaccviol},
                                       {0xE0000000U, iaccviol},
                                       {0x60000000U, ibuserr},
                                       {0x20000000U, invstate},
                                       {0x20000002U, invstate}})
      for (const uint16_t branch : {uint16_t{0x4700}, uint16_t{0x4780}}) {  // bx r0, blx r0
        Bench b;
        choose(b.core, executor);
        b.start({branch});
        b.core.set_reg(0, target);
        b.core.run(10);
        EXPECT_EQ(b.core.first_fault().cfsr, cfsr) << std::hex << target;
        EXPECT_EQ(b.core.first_fault().frame[6], target);
        EXPECT_EQ(b.core.first_fault().frame[7] >> 24 & 1, 0U) << "EPSR.T is stacked as it was";
      }
}
TEST(Exceptions, AnEvenVectorIntoDeviceMemoryIsAViolationOfTheFetch) {
  Bench b;
  b.word(4 * 11, 0x40000000);
  b.start({0xDF00});  // svc
  b.core.run(30);
  EXPECT_EQ(b.core.first_fault().cfsr, 1U);
}
TEST(Exceptions, BranchingToAnEvenAddressFaultsAtTheTarget) {
  Bench b;
  b.start({0x4700});
  b.core.set_reg(0, 0x2000);
  b.core.run(8);
  EXPECT_EQ(b.core.last_fault().cfsr, 1u << 17);
  EXPECT_EQ(b.core.last_fault().frame[6], 0x2000u);
}

// B1.5.17
TEST(Exceptions, WfiWakesThoughPrimaskIsSet) {
  Bench b;
  b.start({0x6025, 0xB672, 0xBF30, 0x2301, 0xE7FE});  // enable; cpsid i; wfi; movs r3,#1
  b.core.set_reg(4, 0xE000E100);
  b.core.set_reg(5, 1);
  EXPECT_EQ(b.core.run(100), StopReason::sleeping);
  b.core.set_interrupt(0, true);
  EXPECT_TRUE(b.core.wake_pending());
  b.core.run(b.core.cycles() + 3);
  EXPECT_EQ(b.core.reg(3), 1u);
  EXPECT_EQ(b.core.state().xpsr() & 0x1FF, 0u);
}

// B1.4.3
TEST(Exceptions, BasepriMasksItsOwnPriorityAndLower) {
  Bench b;
  // str r5,[r4]; strb r6,[r7]; msr basepri,r6; b .; msr basepri,r0; b .
  b.start({0x6025, 0x703E, 0xF386, 0x8811, 0xE7FE, 0xF380, 0x8811, 0xE7FE});
  b.core.set_reg(4, 0xE000E100);
  b.core.set_reg(5, 1);
  b.core.set_reg(6, 0x80);
  b.core.set_reg(7, 0xE000E400);
  b.core.set_reg(0, 0xA0);
  b.core.run(20);
  b.core.set_interrupt(0, true);
  b.core.run(40);
  EXPECT_EQ(b.core.state().basepri, 0x80u);
  EXPECT_EQ(b.core.state().xpsr() & 0x1FF, 0u);
  b.core.set_reg(15, Bench::program + 10);
  b.core.run(46);
  EXPECT_EQ(b.core.state().xpsr() & 0x1FF, 16u);
}

// B1.5.12, B3.4.1
TEST(Exceptions, ALevelStillHighAtTheReturnTailChains) {
  Bench b;
  b.start({0x6025, 0xE7FE});
  b.core.set_reg(4, 0xE000E100);
  b.core.set_reg(5, 1);
  b.core.set_interrupt(0, true);
  b.core.run(14);
  EXPECT_EQ(b.core.state().xpsr() & 0x1FF, 16u);
  uint32_t sp = b.core.state().msp();
  b.core.run(18);  // bx lr, 3 cycles, and 6 of the tail-chain
  EXPECT_EQ(b.core.state().xpsr() & 0x1FF, 16u);
  EXPECT_EQ(b.core.state().msp(), sp);
  b.core.set_interrupt(0, false);
  b.core.run(80);
  EXPECT_EQ(b.core.state().xpsr() & 0x1FF, 0u);
}

TEST(Exceptions, SemihostingGoesToTheHandlerWhichMayEndTheRun) {
  Bench b;
  b.core.listeners().semihosting = [](Core& core) { return core.reg(0) != 0x20; };
  b.start({0xBEAB, 0x2020, 0xBEAB, 0xE7FE});
  EXPECT_EQ(b.core.run(1000), StopReason::semihosting_exit);
  EXPECT_EQ(b.core.reg(15), Bench::program + 6);
}

// The host's answer takes no time of the guest's, however often it is asked for, and an exception
// that becomes pending meanwhile comes after it.
TEST(Exceptions, ASemihostingCallIsRepeatedUntilItIsAnswered) {
  for (unsigned waits : {0U, 1U, 3U}) {
    for (Executor executor : {Executor::stepping, Executor::blocks, Executor::translator}) {
      Bench b;
      unsigned asked = 0;
      b.core.set_executor(executor);
      b.core.listeners().semihosting = [&](Core& core) {
        EXPECT_EQ(core.reg(15), Bench::program + 4);
        if (asked++ < waits)
          core.ask_again();
        else
          core.set_reg(0, 42);
        return true;
      };
      b.start({0x2007, 0xBEAB, 0x0001, 0x6025, 0xE7FE});  // movs r0,#7; bkpt 0xAB; movs r1,r0; ...
      b.core.set_reg(4, 0xE000E100);
      b.core.set_reg(5, 1);
      for (unsigned i = 0; i < waits; ++i) {
        EXPECT_EQ(b.core.run(1000), StopReason::semihosting_waits);
        EXPECT_TRUE(b.core.waits_for_answer());
        EXPECT_EQ(b.core.reg(0), 7u);
        b.core.set_interrupt(0, true);
      }
      b.core.set_interrupt(0, true);
      EXPECT_EQ(b.core.run(12), StopReason::budget);
      EXPECT_FALSE(b.core.waits_for_answer());
      EXPECT_EQ(b.core.reg(0), 42u);
      EXPECT_EQ(b.core.reg(1), 42u);
      EXPECT_EQ(asked, waits + 1);
      EXPECT_EQ(b.core.state().xpsr() & 0x1FF, 16u);
      static std::pair<uint64_t, uint64_t> first;
      const std::pair position{b.core.cycles(), b.core.instructions()};
      if (waits == 0 && executor == Executor::stepping) first = position;
      EXPECT_EQ(position, first);
    }
  }
}

TEST(Exceptions, AnAnswerThatComesLaterMayEndTheRun) {
  Bench b;
  bool is_asked = false;
  b.core.listeners().semihosting = [&](Core& core) {
    if (std::exchange(is_asked, true)) return false;
    core.ask_again();
    return true;
  };
  b.start({0xBEAB, 0xE7FE});
  EXPECT_EQ(b.core.run(1000), StopReason::semihosting_waits);
  EXPECT_EQ(b.core.run(1000), StopReason::semihosting_exit);
  EXPECT_FALSE(b.core.waits_for_answer());
}

// B1.5.8
TEST(Exceptions, AReturnWithAReservedValueRaisesInvpc) {
  Bench b;
  b.code(0x4000 + 32 * 11, {0x2002, 0x4240, 0x4700});  // movs r0,#2; negs r0,r0; bx r0 = 0xFFFFFFFE
  b.start({0xDF00, 0xE7FE});
  b.core.run(25);
  EXPECT_EQ(b.core.last_fault().cfsr, 1u << 18);
}

// B3.3.1
TEST(Exceptions, SysTickPendsEveryReloadPlusOneCycles) {
  Bench b;
  // r4 = SysTick: str r5,[r4,#4]; str r6,[r4,#8]; str r7,[r4]; wfi
  b.start({0x6065, 0x60A6, 0x6027, 0xBF30, 0xE7FD});
  b.core.set_reg(4, 0xE000E010);
  b.core.set_reg(5, 99);
  b.core.set_reg(7, 7);
  EXPECT_EQ(b.core.run(1000), StopReason::sleeping);
  uint64_t first = b.core.next_internal_event();
  EXPECT_EQ(first, 102u);  // enabled in cycle 2: one tick reloads, 99 count down
  b.core.skip_to(first);
  b.core.run(first + 1);
  EXPECT_EQ(b.core.state().xpsr() & 0x1FF, 15u);
  EXPECT_EQ(b.core.next_internal_event(), first + 100);
}

// B3.5.3
TEST(Exceptions, TheMpuForbidsWhatNoRegionAllows) {
  Bench b;
  // str r5,[r4] (MPU_CTRL=1, no region, no PRIVDEFENA): the next fetch faults
  b.start({0x6025, 0xE7FE});
  b.core.set_reg(4, 0xE000ED94);
  b.core.set_reg(5, 1);
  b.core.run(5);
  EXPECT_EQ(b.core.last_fault().cfsr & 1, 1u);
}

// B3.3.3
TEST(Exceptions, DebugReadsLeaveCountflagAlone) {
  Bench b;
  b.start({0x6065, 0x60A6, 0x6027, 0xE7FE});
  b.core.set_reg(4, 0xE000E010);
  b.core.set_reg(5, 9);
  b.core.set_reg(7, 5);
  b.core.run(100);
  EXPECT_EQ(b.peek(0xE000E010) >> 16, 1u);
  EXPECT_EQ(b.peek(0xE000E010) >> 16, 1u);
}

}  // namespace capsoc::armv7m::test
