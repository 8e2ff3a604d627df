// Parts of the processor on a separate context, without the parts above them.
#include <gtest/gtest.h>

#include <cstring>

#include "armv7m/pending_exceptions.h"
#include "armv7m/watchpoints.h"
#include "bench.h"

namespace capsoc::armv7m::test {
namespace {

constexpr unsigned interrupt_0 = exception::first_interrupt;

struct Parts {
  Bench bench;  // whose core stands for the one that listeners are given
  CoreContext context{bench.core};
  PendingExceptions pending{context};
  Watchpoints watchpoints{context, pending};

  Parts() { context.state.reset(armv7m_registers); }
};

}  // namespace

TEST(Pending, AnExceptionWaitsUntilItsPriorityIsSufficient) {
  Parts p;
  EXPECT_EQ(p.pending.execution_priority(), 256);
  EXPECT_EQ(p.pending.highest_pending(256), 0u);
  p.pending.pend(exception::pendsv);
  EXPECT_TRUE(p.context.requests.any()) << "the run loop has to look";
  EXPECT_EQ(p.pending.highest_pending(256), unsigned{exception::pendsv});
  EXPECT_EQ(p.pending.highest_pending(0), 0u) << "it does not preempt its own priority";
  p.context.state.primask = 1;
  EXPECT_EQ(p.pending.execution_priority(), 0);
  EXPECT_EQ(p.pending.execution_priority(true), 256) << "as WFI sees it";
  EXPECT_EQ(p.pending.highest_pending(p.pending.execution_priority()), 0u);
  p.pending.pend(exception::nmi);
  EXPECT_EQ(p.pending.highest_pending(p.pending.execution_priority()), unsigned{exception::nmi});
}

TEST(Pending, AnInterruptThatIsNotEnabledIsPendingAndNotTaken) {
  Parts p;
  std::vector<unsigned> told;
  p.context.listeners.pended = [&](unsigned number) { told.push_back(number); };
  p.pending.pend(interrupt_0 + 3);
  p.pending.pend(interrupt_0 + 3);
  EXPECT_EQ(told, std::vector<unsigned>{interrupt_0 + 3}) << "once, when it becomes pending";
  EXPECT_FALSE(p.pending.enabled(interrupt_0 + 3));
  EXPECT_EQ(p.pending.highest_pending(256), 0u);
  EXPECT_FALSE(p.pending.wake_pending());
}

TEST(Pending, AnImpreciseFaultOfADisabledBusFaultIsAHardFault) {
  Parts p;
  p.pending.imprecise_bus_fault({true, 0x40000000, 7, 0x1000, 12});
  EXPECT_EQ(p.pending.highest_pending(256), unsigned{exception::hard_fault});
  EXPECT_EQ(p.context.state.lost_write.address, 0x40000000u);
  p.pending.imprecise_bus_fault({true, 0x40000004, 7, 0x1000, 13});
  EXPECT_EQ(p.context.state.lost_write.address, 0x40000000u) << "of the first that fails";
}

TEST(Context, AFaultIsLeftForTheRunLoop) {
  Parts p;
  EXPECT_FALSE(p.context.fault(0x1234, Cause::undefined_instruction, 5));
  EXPECT_EQ(p.context.event.kind, Event::Kind::fault);
  EXPECT_EQ(p.context.event.value, 5u);
  EXPECT_EQ(p.context.state.pc, 0x1234u);
}

TEST(Context, ACaseIsReportedOnceWithItsInstructionAsThePc) {
  Parts p;
  unsigned reports = 0;
  p.context.listeners.unpredictable = [&](Unpredictable, uint32_t address) {
    ++reports;
    EXPECT_EQ(address, 0x1000u);
    EXPECT_EQ(p.context.state.pc, 0x1000u);
  };
  p.context.state.pc = 0x1004;
  p.context.report(Unpredictable::should_be_bits, 0x1000);
  p.context.report(Unpredictable::should_be_bits, 0x1000);
  EXPECT_EQ(reports, 1u);
  EXPECT_EQ(p.context.state.pc, 0x1004u);
}

TEST(Watching, AnAccessThatTouchesAWatchedByteIsAHit) {
  Parts p;
  EXPECT_FALSE(p.watchpoints.watches_data());
  p.watchpoints.add({0x20000002, 1, false, true});
  EXPECT_TRUE(p.watchpoints.watches_data());
  EXPECT_TRUE(p.watchpoints.watches_page(0x20000FFC, true));
  EXPECT_FALSE(p.watchpoints.watches_page(0x20000FFC, false)) << "loads go the direct way";
  EXPECT_FALSE(p.watchpoints.watches_page(0x20001000, true));
  EXPECT_FALSE(p.watchpoints.watched(0x20000000, 4, false)) << "a read";
  EXPECT_FALSE(p.watchpoints.watched(0x20000000, 2, true)) << "beside it";
  EXPECT_TRUE(p.watchpoints.watched(0x20000000, 4, true));
  EXPECT_EQ(p.watchpoints.hit().address, 0x20000002u);
  EXPECT_TRUE(p.context.requests.has(Requests::watchpoint));
  EXPECT_TRUE(p.watchpoints.remove({0x20000002, 1, false, true}));
  EXPECT_FALSE(p.watchpoints.remove({0x20000002, 1, false, true}));
  EXPECT_FALSE(p.watchpoints.watches_data());
}

TEST(Halting, DhcsrShowsAnAttachedDebuggerOnly) {
  HaltingDebug halting;
  halting.set_halted(true);
  EXPECT_EQ(halting.control_and_status(), 0u);
  halting.set_enabled(true);
  EXPECT_EQ(halting.control_and_status(), 0x30003u);
  halting.set_halted(false);
  EXPECT_EQ(halting.control_and_status(), 1u);
}

}  // namespace capsoc::armv7m::test
