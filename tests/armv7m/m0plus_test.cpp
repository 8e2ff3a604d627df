// What the Cortex-M0+ has and has not (ARM DDI 0419, Armv6-M; DDI 0484, its TRM), in every
// executor.
#include <gtest/gtest.h>

#include <cstdint>
#include <initializer_list>
#include <vector>

#include "armv7m/system/registers.h"
#include "bench.h"
#include "executors.h"

namespace capsoc::armv7m::test {
namespace {

constexpr uint32_t handler(unsigned exception) {
  return 0x4000 + 32 * exception;
}
constexpr uint32_t nowhere = 0x60000000, shcsr = 0xE000ED24, cfsr = 0xE000ED28;
constexpr uint16_t stay = 0xE7FE;  // b .

class M0plus : public testing::TestWithParam<Executor> {
 protected:
  Bench b{0, cortex_m0plus};

  void SetUp() override {
    choose(b.core, GetParam());
    b.code(handler(exception::hard_fault), {stay});
  }
  const State& state() const { return b.core.state(); }
  /// Executes `code` and stays past it, or in HardFault. `values`: of r0 and on.
  void run(std::initializer_list<uint16_t> code, std::initializer_list<uint32_t> values = {}) {
    b.start(code);
    b.code(Bench::program + 2 * static_cast<uint32_t>(code.size()), {stay});
    unsigned n = 0;
    for (const uint32_t value : values) b.core.set_reg(n++, value);
    b.core.run(b.core.cycles() + 200);
  }
  void expect_hard_fault(uint32_t cause, uint32_t address = Bench::program) {
    EXPECT_EQ(state().ipsr, unsigned{exception::hard_fault});
    EXPECT_EQ(b.core.fault_count(), 1u);
    EXPECT_EQ(b.core.last_fault().kind, FaultReport::Kind::hard_fault);
    EXPECT_EQ(b.core.last_fault().cfsr, cause) << "as the report tells it";
    EXPECT_EQ(b.core.last_fault().registers.r[15], address);
  }
  /// A debugger's look at a register.
  void write(uint32_t address, uint32_t value) { b.core.debug_write(address, &value, 4); }
};

INSTANTIATE_TEST_SUITE_P(Executors, M0plus, testing::ValuesIn(all_executors), executor_name);

// A5.2 and A5.3: the sets of instructions.
TEST_P(M0plus, InstructionsOfArmv7MAreUndefined) {
  const std::vector<std::vector<uint16_t>> missing = {
      {0xFBB1, 0xF0F2},  // udiv
      {0xB100},          // cbz
      {0xB900},          // cbnz
      {0xBF08},          // it eq
      {0xE851, 0x0F00},  // ldrex
      {0xF3BF, 0x8F2F},  // clrex
      {0xF240, 0x0001},  // movw
      {0xF000, 0x8000},  // beq.w
      {0xF000, 0xB800},  // b.w
      {0xF3AF, 0x8000},  // nop.w
      {0xEE00, 0x0A10},  // a coprocessor
      {0xF7F0, 0xA000},  // udf.w
      {0xDE00},          // udf
  };
  for (const std::vector<uint16_t>& code : missing) {
    Bench one(0, cortex_m0plus);
    choose(one.core, GetParam());
    one.code(handler(exception::hard_fault), {stay});
    one.start({code.front(), code.back(), stay});
    one.core.run(100);
    EXPECT_EQ(one.core.state().ipsr, unsigned{exception::hard_fault}) << std::hex << code.front();
    EXPECT_EQ(one.core.last_fault().cfsr, 1u << 16) << std::hex << code.front();
  }
}

TEST_P(M0plus, TheSixWideInstructionsAreThere) {
  // bl over a branch; mrs r0, primask; msr primask, r1; dsb; dmb; isb
  run({0xF000, 0xF801, 0xE7FE, 0xF3EF, 0x8010, 0xF381, 0x8810, 0xF3BF, 0x8F4F, 0xF3BF, 0x8F5F,
       0xF3BF, 0x8F6F},
      {7, 1});
  EXPECT_EQ(b.core.fault_count(), 0u);
  EXPECT_EQ(b.core.reg(0), 0u);
  EXPECT_EQ(state().primask, 1u);
  EXPECT_EQ(b.core.reg(14), Bench::program + 5);
}

// A3.2.1 and B3.2.8: unaligned accesses fault always.
TEST_P(M0plus, UnalignedAccessesAreHardFaults) {
  for (const uint16_t access : {0x6808, 0x8808, 0x6008, 0x8008, 0xC901, 0xC101}) {
    b.core.reset();
    const uint64_t before = b.core.fault_count();
    run({access}, {0, Bench::ram_base + 1});  // ldr, ldrh, str, strh r0,[r1]; ldm, stm r1!,{r0}
    EXPECT_EQ(b.core.fault_count(), before + 1) << std::hex << access;
    EXPECT_EQ(b.core.last_fault().cfsr, 1u << 24) << std::hex << access;
    EXPECT_EQ(state().ipsr, unsigned{exception::hard_fault});
  }
}

TEST_P(M0plus, ConfigurationIsFixed) {
  run({0x6008, 0x6808}, {0, ppb::CCR});
  EXPECT_EQ(b.core.reg(0), 0x208u) << "STKALIGN and UNALIGN_TRP";
}

// B1.5.1: there is no other fault; B3.2: nor a register that tells which.
TEST_P(M0plus, BusErrorsAreHardFaultsAtTheInstruction) {
  run({0x6808}, {0, nowhere});
  expect_hard_fault(1u << 9 | 1u << 15);
}
TEST_P(M0plus, StoresAreNotBuffered) {
  run({0x6008, 0x2305}, {0, nowhere});  // str r0,[r1]; movs r3,#5
  expect_hard_fault(1u << 9 | 1u << 15);
  EXPECT_EQ(b.core.reg(3), 0u);
  EXPECT_EQ(b.core.last_fault().address, nowhere);
}
TEST_P(M0plus, FetchesFromWhereNothingIsExecutedAreHardFaults) {
  run({0x4708}, {0, 0x40000001});  // bx r1
  expect_hard_fault(1u << 0, 0x40000000);
}
TEST_P(M0plus, LeavingThumbStateIsAHardFault) {
  run({0x4708}, {0, Bench::program + 0x100});
  expect_hard_fault(1u << 17, Bench::program + 0x100);
}
TEST_P(M0plus, FaultsCannotBeEnabledOneByOne) {
  run({0x6008, 0x6011}, {0x70000, shcsr, nowhere});  // str r0,[r1]; str r1,[r2]
  EXPECT_EQ(state().ipsr, unsigned{exception::hard_fault});
  EXPECT_EQ(b.peek(shcsr), 0u);
}
TEST_P(M0plus, FaultStatusReadsZero) {
  run({0x6808}, {0, nowhere});
  for (uint32_t address = cfsr; address <= 0xE000ED38; address += 4)
    EXPECT_EQ(b.peek(address), 0u) << address;
}
TEST_P(M0plus, AReportTellsTheCauseOfItsFaultAlone) {
  // HardFault steps over the instruction: ldr r0,[sp,#24]; adds r0,#2; str r0,[sp,#24]; bx lr
  b.code(handler(exception::hard_fault), {0x9806, 0x3002, 0x9006, 0x4770});
  run({0x6808, 0xDE00}, {0, nowhere});
  EXPECT_EQ(b.core.fault_count(), 2u);
  EXPECT_EQ(b.core.last_fault().cfsr, 1u << 16) << "no bus error any more";
}

// B1.5.4: four levels; B3.4.7 and B3.2.9: the fields in words.
TEST_P(M0plus, PrioritiesHaveTwoBits) {
  run({0x6008, 0x6808, 0x601A, 0x681A, 0x602C, 0x682C},
      {0xFFFFFFFF, ppb::NVIC_IPR, 0xFFFFFFFF, 0xE000ED20, 0xFFFFFFFF, 0xE000ED1C});
  EXPECT_EQ(b.core.reg(0), 0xC0C0C0C0u);
  EXPECT_EQ(b.core.reg(2), 0xC0C00000u) << "SHPR3: PendSV and SysTick";
  EXPECT_EQ(b.core.reg(4), 0xC0000000u) << "SHPR2: SVCall";
  EXPECT_EQ(b.peek(0xE000ED18), 0u) << "SHPR1";
}
TEST_P(M0plus, TheNumberOfPriorityBitsCannotBeSet) {
  b.core.set_priority_bits(8);
  run({0x6008, 0x6808}, {0xFFFFFFFF, ppb::NVIC_IPR});
  EXPECT_EQ(b.core.reg(0), 0xC0C0C0C0u);
}
TEST_P(M0plus, DroppedPriorityBitsAreToldOfTheFieldsThatThereAre) {
  std::vector<DroppedPriority> told;
  b.core.listeners().priority = [&](const DroppedPriority& each) { told.push_back(each); };
  run({0x6008}, {0x20202020, 0xE000ED18});  // SHPR1 is not there
  EXPECT_TRUE(told.empty());
  run({0x6008}, {0x20, 0xE000ED20});  // nor are the low half's fields of SHPR3
  EXPECT_TRUE(told.empty());
  run({0x6008}, {0x20000000, 0xE000ED20});
  EXPECT_EQ(told.size(), 1u);
}
TEST_P(M0plus, AnInterruptPreemptsOneOfALowerLevelOnly) {
  std::vector<unsigned> order;
  b.on_write = [&](uint32_t) { order.push_back(state().ipsr); };
  // Interrupt 0 pends 1 and 2 (r3 in r2, ISPR) and tells; so do they.
  b.code(handler(16), {0x6013, 0x6020, 0x4770});
  b.code(handler(17), {0x6020, 0x4770});
  b.code(handler(18), {0x6020, 0x4770});
  write(ppb::NVIC_ISER, 7);
  b.start({0x6016, stay});
  write(ppb::NVIC_ISER, 7);
  write(ppb::NVIC_IPR, 0x004080);  // 0: 0x80, 1: 0x40, 2: 0
  b.core.set_reg(2, ppb::NVIC_ISPR);
  b.core.set_reg(3, 6);
  b.core.set_reg(4, 0x40000000);
  b.core.set_reg(6, 1);
  b.core.run(500);
  EXPECT_EQ(order, (std::vector<unsigned>{18, 17, 16}));
}
TEST_P(M0plus, ThereIsNoPriorityGroup) {
  run({0x6008, 0x6808}, {0x05FA0700, ppb::AIRCR});
  EXPECT_EQ(b.core.reg(0), 0xFA050000u);
}
TEST_P(M0plus, AProgramCanAskForAReset) {
  b.start({0x6008, stay});
  b.core.set_reg(0, 0x05FA0004);
  b.core.set_reg(1, ppb::AIRCR);
  EXPECT_EQ(b.core.run(100), StopReason::reset_request);
}

// B4.2: the special registers that there are.
TEST_P(M0plus, BasepriAndFaultmaskAreUnknown) {
  // msr basepri, r0; msr basepri_max, r0; msr faultmask, r0; mrs r1 to r3 of each
  run({0xF380, 0x8811, 0xF380, 0x8812, 0xF380, 0x8813, 0xF3EF, 0x8111, 0xF3EF, 0x8212, 0xF3EF,
       0x8313},
      {0xFF, 1, 1, 1});
  EXPECT_EQ(b.core.fault_count(), 0u) << "UNPREDICTABLE: they read as zero and ignore writes";
  EXPECT_EQ(b.core.reg(1) | b.core.reg(2) | b.core.reg(3), 0u);
  EXPECT_EQ(state().basepri | state().faultmask, 0u);
}
TEST_P(M0plus, CpsKnowsPrimaskAlone) {
  std::vector<Unpredictable> told;
  b.core.listeners().unpredictable = [&](Unpredictable which, uint32_t) { told.push_back(which); };
  run({0xB672});  // cpsid i
  EXPECT_EQ(state().primask, 1u);
  EXPECT_TRUE(told.empty());
  run({0xB673});  // cpsid if
  EXPECT_EQ(state().primask, 1u);
  EXPECT_EQ(state().faultmask, 0u);
  EXPECT_EQ(told, std::vector<Unpredictable>{Unpredictable::should_be_bits});
}
TEST_P(M0plus, ThereIsNoSaturationFlag) {
  run({0xF380, 0x8800, 0xF3EF, 0x8100}, {0xF8000000});  // msr apsr, r0; mrs r1, apsr
  EXPECT_EQ(b.core.reg(1), 0xF0000000u);
}
TEST_P(M0plus, AReturnTakesWhatTheProgramStatusHas) {
  // SVCall: ldr r0,[sp,#28]; orrs r0,r6; str r0,[sp,#28]; bx lr
  b.code(handler(exception::svcall), {0x9807, 0x4330, 0x9007, 0x4770});
  b.start({0xDF00, 0x2301, stay});
  b.core.set_reg(6, 0x0E00FDC0);  // Q, all of IT, and a number beyond six bits
  b.core.run(200);
  EXPECT_EQ(b.core.fault_count(), 0u);
  EXPECT_EQ(b.core.reg(3), 1u);
  EXPECT_EQ(state().xpsr() & 0x0FFFFFFFu, 1u << 24);
}
TEST_P(M0plus, FramesAreAlwaysAligned) {
  b.code(handler(exception::svcall), {stay});
  b.start({0xB082, 0xB081, 0xDF00, stay});  // sub sp,#8; sub sp,#4; svc
  b.core.run(100);
  EXPECT_EQ(b.core.reg(13), Bench::stack - 16 - 32);
  EXPECT_NE(b.peek(b.core.reg(13) + 28) & 1u << 9, 0u);
}

// B1.5.6 and B1.5.11: what escalates, and where it ends.
TEST_P(M0plus, AnSvcThatCannotPreemptIsAHardFault) {
  run({0xB672, 0xDF00});  // cpsid i; svc
  EXPECT_EQ(state().ipsr, unsigned{exception::hard_fault});
  EXPECT_EQ(b.core.last_fault().hfsr, 1u << 30);
}
TEST_P(M0plus, ABreakpointIsAHardFault) {
  write(0xE000EDFC, 1u << 16);  // DEMCR.MON_EN of Armv7-M
  run({0xBE00});
  EXPECT_EQ(state().ipsr, unsigned{exception::hard_fault});
  EXPECT_EQ(b.core.last_fault().hfsr, 1u << 31);
}
TEST_P(M0plus, AFaultInHardFaultIsALockup) {
  for (const uint16_t second : {0xDE00, 0xDF00, 0xBE00, 0x6808}) {  // udf, svc, bkpt, ldr r0,[r1]
    b.code(handler(exception::hard_fault), {second, stay});
    run({0xDE00}, {0, nowhere});
    EXPECT_TRUE(b.core.locked_up()) << std::hex << second;
    EXPECT_EQ(b.core.reg(15), 0xFFFFFFFEu);
  }
}
TEST_P(M0plus, AnNmiLeavesTheLockupOfHardFault) {
  b.code(handler(exception::hard_fault), {0xDE00});
  b.code(handler(exception::nmi), {stay});
  run({0xDE00});
  ASSERT_TRUE(b.core.locked_up());
  b.core.pulse_nmi();
  b.core.run(b.core.cycles() + 50);
  EXPECT_FALSE(b.core.locked_up());
  EXPECT_EQ(state().ipsr, unsigned{exception::nmi});
}
// DDI 0484, 3.6.1: "Exceptions on stacking from HardFault to NMI lockup at NMI priority."
TEST_P(M0plus, StackingThatFailsBetweenHardFaultAndNmiIsALockup) {
  for (const Profile* profile : {&cortex_m3, &cortex_m0plus}) {
    Bench one(0, *profile);
    choose(one.core, GetParam());
    one.code(handler(exception::hard_fault), {0x468D, stay});  // mov sp,r1
    one.code(handler(exception::nmi), {stay});
    one.start({0xDE00});
    one.core.set_reg(1, nowhere);
    one.core.run(100);
    ASSERT_EQ(one.core.reg(13), nowhere);
    one.core.pulse_nmi();
    one.core.run(one.core.cycles() + 100);
    EXPECT_EQ(one.core.locked_up(), profile == &cortex_m0plus) << profile->name;
    EXPECT_EQ(one.core.state().ipsr, unsigned{exception::nmi}) << profile->name;
    if (profile == &cortex_m3) continue;
    one.core.pulse_nmi();
    EXPECT_EQ(one.core.run(one.core.cycles() + 100), StopReason::lockup) << "at NMI's priority";
  }
}

// B2.1, B3.1, B3.5, C1: what else is not there.
TEST_P(M0plus, ThereIsNoBitBand) {
  run({0x6808}, {0, 0x22000000});
  expect_hard_fault(1u << 9 | 1u << 15);
}
TEST_P(M0plus, ThereIsNoMpu) {
  run({0x6008, 0x6808, 0x601A, 0x681A, 0x682C},
      {7, ppb::MPU_CTRL, 7, ppb::MPU_RNR, 7, ppb::MPU_TYPE});
  EXPECT_EQ(b.core.reg(0) | b.core.reg(2) | b.core.reg(4), 0u);
  EXPECT_EQ(b.core.fault_count(), 0u);
}
TEST_P(M0plus, DebugComponentsAreADebuggersAlone) {
  unsigned heard = 0;
  b.core.listeners().stimulus = [&](unsigned, uint32_t, unsigned) { ++heard; };
  b.core.debugging().show_stimulus(1, true);
  const uint32_t ones = 0xFFFFFFFF;
  // DEMCR, DWT_CTRL, ITM_TCR, FP_CTRL: str, ldr
  run({0x6008, 0x6808, 0x6010, 0x6812, 0x6018, 0x681B, 0x6020, 0x6824},
      {ones, 0xE000EDFC, ppb::DWT_CTRL, ppb::ITM_TCR, 0xE0002000});
  EXPECT_EQ(b.core.reg(0) | b.core.reg(2) | b.core.reg(3) | b.core.reg(4), 0u);
  run({0x6008, 0x680A}, {'a', ppb::ITM_STIM, 1});
  EXPECT_EQ(b.core.reg(2), 0u) << "not ready";
  run({0x6808}, {0, ppb::DWT_CYCCNT});
  EXPECT_EQ(b.core.reg(0), 0u);
  EXPECT_EQ(heard, 0u);
}
TEST_P(M0plus, CodeWithoutPrivilegeDoesNotReachTheSystemRegisters) {
  for (const uint32_t address : {uint32_t{ppb::SYST_CVR}, uint32_t{ppb::ITM_STIM}}) {
    b.core.reset();
    run({0xF380, 0x8814, 0xF3BF, 0x8F6F, 0x6809}, {1, address});  // msr control, r0; isb; ldr
    EXPECT_EQ(state().ipsr, unsigned{exception::hard_fault});
    EXPECT_EQ(b.core.last_fault().cfsr, 1u << 9 | 1u << 15);
  }
}
TEST_P(M0plus, SaysWhatItIs) {
  run({0x6808, 0x6812, 0x681B}, {0, ppb::CPUID, 0xE000ED40, 0xE000ED60});
  EXPECT_EQ(b.core.reg(0), 0x410CC601u);
  EXPECT_EQ(b.core.reg(2) | b.core.reg(3), 0u) << "no other identification";
}
TEST_P(M0plus, NothingTellsWhetherAReturnLeadsToThread) {
  run({0x6808}, {0, ppb::ICSR});
  EXPECT_EQ(b.core.reg(0), 0u) << "RETTOBASE of Armv7-M";
}
TEST_P(M0plus, TheVectorTableMovesInStepsOf256Bytes) {
  run({0x6008, 0x6808}, {0xFFFFFFFF, ppb::VTOR});
  EXPECT_EQ(b.core.reg(0), 0xFFFFFF00u);
}

// DDI 0484C, table 3-1.
TEST_P(M0plus, EachInstructionTakesTheTimeOfTheManual) {
  struct Row {
    const char* text;
    std::initializer_list<uint16_t> code;
    unsigned cycles;
  };
  const Row rows[] = {
      {"movs r0,#1", {0x2001}, 1},
      {"mov r8,r0", {0x4680}, 1},
      {"mov pc,r7", {0x46BF}, 2},
      {"add pc,r6", {0x44B7}, 2},
      {"adds r0,r1,r2", {0x1888}, 1},
      {"adr r0", {0xA000}, 1},
      {"muls r0,r1", {0x4348}, 1},
      {"cmp r0,r1", {0x4288}, 1},
      {"lsls r0,r1", {0x4088}, 1},
      {"uxtb r0,r1", {0xB2C8}, 1},
      {"rev r0,r1", {0xBA08}, 1},
      {"ldr r0,[r4]", {0x6820}, 2},
      {"ldr r0,[r4,r6]", {0x59A0}, 2},
      {"ldrsh r0,[r4,r6]", {0x5FA0}, 2},
      {"ldr r0,[pc]", {0x4800}, 2},
      {"ldr r0,[sp]", {0x9800}, 2},
      {"str r0,[r4]", {0x6020}, 2},
      {"str r0,[r4,r6]", {0x51A0}, 2},
      {"strb r0,[r4]", {0x7020}, 2},
      {"ldr, ldr: nothing overlaps", {0x6820, 0x6821}, 4},
      {"adds r4,#4; ldr r0,[r4]: nothing stalls", {0x3404, 0x6820}, 3},
      {"ldm r4!,{r0-r3}", {0xCC0F}, 5},
      {"stm r4!,{r0-r3}", {0xC40F}, 5},
      {"push {r0-r3}", {0xB40F}, 5},
      {"push {r0-r3,lr}", {0xB50F}, 6},
      {"pop {r0-r3}", {0xBC0F}, 5},
      {"push {r7}; pop {pc}", {0xB480, 0xBD00}, 2 + 4},
      {"push {r0-r1}; push {r6}; pop {r0}; pop {r0-r1}", {0xB403, 0xB440, 0xBC01, 0xBC03}, 10},
      {"beq, not taken", {0xD0FF}, 1},
      {"bne, taken", {0xD1FF}, 2},
      {"b", {0xE7FF}, 2},
      {"bl", {0xF000, 0xF800}, 3},
      {"bx r7", {0x4738}, 2},
      {"blx r7", {0x47B8}, 2},
      {"cpsie i", {0xB662}, 1},
      {"mrs r0,apsr", {0xF3EF, 0x8000}, 3},
      {"msr primask,r6", {0xF386, 0x8810}, 3},
      {"nop", {0xBF00}, 1},
      {"yield", {0xBF10}, 1},
      {"sev; wfe", {0xBF40, 0xBF20}, 3},
      {"isb", {0xF3BF, 0x8F6F}, 3},
      {"dmb", {0xF3BF, 0x8F5F}, 3},
      {"dsb", {0xF3BF, 0x8F4F}, 3},
      {"b to bl, which is not aligned: no longer", {0xE7FF, 0xF000, 0xF800}, 5},
  };
  for (const Row& row : rows) {
    Bench one(0, cortex_m0plus);
    choose(one.core, GetParam());
    one.start(row.code);
    const uint32_t end = Bench::program + 2 * static_cast<uint32_t>(row.code.size());
    one.code(end, {stay});
    one.core.set_reg(1, 3);
    one.core.set_reg(4, Bench::ram_base);
    one.core.set_reg(7, end | 1);
    one.core.edit().z = 1;
    // ADD PC: 4 beyond it is the end.
    if (row.code.begin()[0] == 0x44B7) one.core.set_reg(6, 0u - 2);
    one.core.run(one.core.cycles() + 1);
    while (one.core.reg(15) != end && one.core.cycles() < 60) one.core.run(one.core.cycles() + 1);
    EXPECT_EQ(one.core.fault_count(), 0u) << row.text;
    EXPECT_EQ(one.core.cycles(), row.cycles) << row.text;
  }
}

// What the manual leaves open (timing.h): 11 cycles back.
TEST_P(M0plus, AnExceptionReturnTakesAsLongAsAPopOfItsFrame) {
  b.start({0xDF00, stay});  // svc; the handler: bx lr
  while (b.core.reg(15) != Bench::program + 2 && b.core.cycles() < 60)
    b.core.run(b.core.cycles() + 1);
  constexpr unsigned svc = 1, bx = 2;
  EXPECT_EQ(b.core.cycles(), svc + 15u + bx + 11u);
}

// DDI 0484C, 3.6.1.
TEST_P(M0plus, AnExceptionIsEnteredInFifteenCycles) {
  std::vector<uint64_t> stores;
  b.on_write = [&](uint32_t) { stores.push_back(b.core.cycles()); };
  b.code(handler(16), {0x6020, 0x4770});  // str r0,[r4]; bx lr
  b.code(handler(17), {0x6020, 0x4770});
  b.start({stay});
  write(ppb::NVIC_ISER, 3);
  b.core.set_reg(4, 0x40000000);
  b.core.run(10);
  b.core.set_interrupt(0, true);
  b.core.set_interrupt(1, true);
  b.core.set_interrupt(0, false);
  b.core.set_interrupt(1, false);
  const uint64_t before = b.core.cycles();
  b.core.run(before + 60);
  ASSERT_EQ(stores.size(), 2u);
  constexpr unsigned store_wait = 2, store = 2, bx = 2, tail_chain = 7;
  EXPECT_EQ(stores[0] - before, 15u);
  EXPECT_EQ(stores[1] - stores[0], store + store_wait + bx + tail_chain);
}

}  // namespace
}  // namespace capsoc::armv7m::test
