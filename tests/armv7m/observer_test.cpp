// The notifications of an observer of the core, and that it changes nothing.
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "bench.h"
#include "executors.h"

namespace capsoc::armv7m::test {
namespace {

/// Notes every call as a word.
class Notes : public Observer {
 public:
  std::vector<std::string> words;
  std::vector<DirectAccess> accesses;
  uint64_t since = 0, at = 0;

  void issued(const Core&, const DecodedOp& op) override { add("issued", op.address); }
  void retired(const Core& core, const DecodedOp&) override { add("retired", core.reg(15)); }
  void entered(const Core& core, unsigned exception, Entry how, uint64_t begin) override {
    constexpr const char* hows[] = {"preempts", "tail-chains", "displaces"};
    add(hows[static_cast<unsigned>(how)], exception);
    since = begin;
    at = core.cycles();
  }
  void returned(const Core&, unsigned exception) override { add("returned", exception); }
  void accessed(const Core&, const DirectAccess& access) override { accesses.push_back(access); }
  void started(const Core& core) override { add("started", core.reg(15)); }

 private:
  void add(const std::string& what, uint32_t number) {
    std::ostringstream text;
    text << what << " " << std::hex << number;
    words.push_back(text.str());
  }
};

TEST(Observer, SeesInstructionsAndExceptionsInTheirOrder) {
  Bench b;
  Notes notes;
  b.core.add_observer(notes, true, false);
  b.start({0xDF00, 0x2301, 0xE7FE});  // svc; movs r3,#1; b .
  b.core.run(60);
  ASSERT_GE(notes.words.size(), 9U);
  notes.words.resize(9);
  EXPECT_EQ(notes.words, (std::vector<std::string>{"started 1000", "issued 1000", "retired 1002",
                                                   "preempts b", "issued 4160", "retired fffffff8",
                                                   "returned b", "issued 1002", "retired 1004"}));
  EXPECT_EQ(notes.at - notes.since, 12U);
}

TEST(ExecutionCounts, RegistersThatWhatWasExecutedMayHaveChanged) {
  for (const Executor executor : {Executor::stepping, Executor::blocks, Executor::translator}) {
    Bench b;
    b.core.set_executor(executor);
    ExecutionCounts counts;
    b.core.count_executions(&counts);
    // movs r2,#1; push {r1}; pop {r5}; b next; movs r7,#0 (skipped over); next: nop; nop; b next
    b.start({0x2201, 0xB402, 0xBC20, 0xE000, 0x2700, 0xBF00, 0xBF00, 0xE7FC});
    b.core.run(30);
    EXPECT_EQ(counts.changed_registers({}), 1U << 2 | 1U << 5 | 1U << 13);
    const auto before = counts.totals();
    b.core.run(300);
    EXPECT_EQ(counts.changed_registers(before), 0U);
    b.core.count_executions(nullptr);
  }
}

TEST(Observer, SeesTailChains) {
  Bench b;
  Notes notes;
  b.core.add_observer(notes, false, false);
  b.code(0x4000 + 32 * 11, {0x6025, 0x4770});  // str r5,[r4]; bx lr
  b.start({0xDF00, 0xE7FE});
  b.core.set_reg(4, 0xE000ED04);
  b.core.set_reg(5, 1U << 28);  // PENDSVSET, of SVCall's priority
  b.core.run(100);
  EXPECT_EQ(notes.words, (std::vector<std::string>{"started 1000", "preempts b", "tail-chains e",
                                                   "returned e"}));
}

TEST(Observer, SeesEveryDirectAccess) {
  for (const Executor executor : all_executors) {
    Bench b;
    Notes notes;
    choose(b.core, executor);
    // 1: strb r0,[r2]; ldrh r1,[r2]; ldr r3,[r4]; ldr r5,[r6]; b 1
    b.start({0x7010, 0x8811, 0x6823, 0x6835, 0xE7FA});
    b.core.set_reg(0, 0xA5);
    b.core.set_reg(2, Bench::ram_base + 0x102);
    b.core.set_reg(4, 0xE000ED00);
    b.core.set_reg(6, 0x40000000);  // a bus sees this one
    b.core.run(200);
    b.core.add_observer(notes, false, true);
    b.core.run(b.core.cycles() + 300);
    ASSERT_GT(notes.accesses.size(), 30U);
    unsigned writes = 0;
    for (const DirectAccess& access : notes.accesses) {
      EXPECT_NE(access.address, 0x40000000U);
      EXPECT_TRUE(access.ok);
      if (!access.write) continue;
      ++writes;
      EXPECT_EQ(access.address, Bench::ram_base + 0x102);
      EXPECT_EQ(access.size, 1U);
      EXPECT_EQ(access.value, 0xA5U);
    }
    EXPECT_GE(writes, 10U);
    notes.accesses.clear();
    b.core.remove_observer(notes);
    b.core.run(b.core.cycles() + 300);
    EXPECT_TRUE(notes.accesses.empty());
  }
}

TEST(Observer, ChangesNoCycle) {
  for (const Executor executor : all_executors) {
    std::vector<std::string> states;
    for (const auto& [instructions, accesses] :
         {std::pair{false, false}, {true, false}, {false, true}, {true, true}}) {
      Bench b(2);
      Notes notes;
      choose(b.core, executor);
      if (instructions || accesses) b.core.add_observer(notes, instructions, accesses);
      // 1: push {r0-r3}; pop {r4-r7}; ldr r0,[r2]; ldr r1,[r2,#1]; str r0,[r3]; svc; b 1
      b.start({0xB40F, 0xBCF0, 0x6810, 0xF8D2, 0x1001, 0x6018, 0xDF00, 0xE7F7});
      b.core.set_reg(2, Bench::ram_base + 0x100);
      b.core.set_reg(3, 0x40000000);
      b.core.run(5000);
      std::ostringstream state;
      state << b.core.cycles() << " " << b.core.instructions();
      for (unsigned n = 0; n < 16; ++n) state << " " << b.core.reg(n);
      states.push_back(state.str());
    }
    for (const std::string& state : states) EXPECT_EQ(state, states.front());
  }
}

}  // namespace
}  // namespace capsoc::armv7m::test
