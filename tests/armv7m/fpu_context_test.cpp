// Who may use the FPU of the Cortex-M4, and how exceptions save it (ARM DDI 0403, B1.5.6 to B1.5.8,
// B3.2.20 to B3.2.22; DDI 0439, its TRM), in every executor.
#include <gtest/gtest.h>

#include <cstdint>
#include <initializer_list>
#include <vector>

#include "armv7m/exception_frame.h"
#include "armv7m/isa/decoder.h"
#include "armv7m/system/registers.h"
#include "base/archive.h"
#include "bench.h"
#include "executors.h"

namespace capsoc::armv7m::test {
namespace {

constexpr uint32_t fp_undefinstr = 1u << 16, fp_nocp = 1u << 19, fp_invpc = 1u << 18,
                   fp_unaligned = 1u << 24;
constexpr uint32_t mlsperr = 1u << 5, lsperr = 1u << 13, mstkerr = 1u << 4, munstkerr = 1u << 3;
constexpr uint32_t lspact = 1, fpccr_user = 2, hfrdy = 1u << 4, mmrdy = 1u << 5, bfrdy = 1u << 6,
                   fpccr_thread = 8, aspen = 1u << 31, lspen = 1u << 30, mon_rdy = 1u << 8;
constexpr uint32_t all_open = 0x00F00000;

class FpuContext : public testing::TestWithParam<Executor> {
 protected:
  /// Code that stays past its end, s0 to s31 with 100 and on, FPSCR with Z and C, the FPU open.
  void prepare(Bench& b, std::initializer_list<uint16_t> code) const {
    choose(b.core, GetParam());
    b.code(Bench::handler(exception::hard_fault), {Bench::stay});
    b.code(Bench::handler(exception::mem_manage), {Bench::stay});
    b.code(Bench::handler(exception::bus_fault), {Bench::stay});
    b.start(code);
    b.code(Bench::program + 2 * static_cast<uint32_t>(code.size()), {Bench::stay});
    write(b, ppb::CPACR, all_open);
    State& state = b.core.edit();
    for (unsigned n = 0; n < Fpu::registers; ++n) state.fpu.set_s(n, 100 + n);
    state.fpu.status() = Fpscr(0x60000000);
  }
  /// The same in the middle of a context.
  void prepare_context(Bench& b, std::initializer_list<uint16_t> code) const {
    prepare(b, code);
    b.core.edit().set_control(State::control_fpca);
  }
  static void write(Bench& b, uint32_t address, uint32_t value) {
    b.core.debug_write(address, &value, 4);
  }
  static void run(Bench& b, uint64_t cycles = 300) { b.core.run(b.core.cycles() + cycles); }
  /// Makes the memory from an address on read-only; `bytes`: a power of two.
  static void protect(Bench& b, uint32_t address, uint32_t bytes, uint32_t permissions = 5) {
    write(b, ppb::MPU_RNR, 0);
    write(b, ppb::MPU_RBAR, address);
    write(b, ppb::MPU_RBAR + 4,
          permissions << 24 | static_cast<uint32_t>(__builtin_ctz(bytes) - 1) << 1 | 1);
    write(b, ppb::MPU_CTRL, 5);
  }
  uint64_t cycles_of(std::initializer_list<uint16_t> code) const {
    Bench b(0, cortex_m4f);
    prepare_context(b, code);
    const uint32_t end = Bench::program + 2 * static_cast<uint32_t>(code.size());
    for (unsigned n = 0; n < 8; ++n) b.core.set_reg(n, Bench::ram_base + 0x100 * n);
    b.core.run(b.core.cycles() + 1);
    while (b.core.reg(15) != end && b.core.cycles() < 100) b.core.run(b.core.cycles() + 1);
    EXPECT_EQ(b.core.fault_count(), 0u);
    return b.core.cycles();
  }
  static void expect_untouched(const Bench& b, uint32_t fpscr = 0x60000000) {
    for (unsigned n = 0; n < Fpu::registers; ++n)
      EXPECT_EQ(b.core.state().fpu.s(n), 100 + n) << "s" << n;
    EXPECT_EQ(b.core.state().fpu.status().bits(), fpscr);
  }
};

INSTANTIATE_TEST_SUITE_P(Executors, FpuContext, testing::ValuesIn(all_executors), executor_name);

// DDI 0439D, table 7-2
TEST_P(FpuContext, SaysWhatItIs) {
  Bench b(0, cortex_m4f);
  prepare(b, {0x6804, 0x684D});  // ldr r4,[r0]; ldr r5,[r1,#4]
  b.core.set_reg(0, ppb::CPUID);
  b.core.set_reg(1, ppb::MVFR0);
  run(b, 50);
  EXPECT_EQ(b.core.reg(4), 0x410FC241u);
  EXPECT_EQ(b.core.reg(5), 0x11000011u) << "MVFR1";
  EXPECT_EQ(b.peek(ppb::MVFR0), 0x10110021u);
  b.core.reset();
  EXPECT_EQ(b.peek(ppb::FPCCR), aspen | lspen);
  EXPECT_EQ(b.peek(ppb::CPACR), 0u);
}

// B3.2.20
TEST_P(FpuContext, IsClosedUntilCpacrOpensIt) {
  struct Row {
    uint32_t cpacr;
    bool privileged, open;
  };
  for (const Row& row :
       {Row{0, true, false}, Row{0x00F00000, true, true}, Row{0x00F00000, false, true},
        Row{0x00500000, true, true}, Row{0x00500000, false, false}, Row{0x00A00000, true, false}}) {
    Bench b(0, cortex_m4f);
    prepare(b, {0xEE10, 0x1A10});  // vmov r1,s0
    write(b, ppb::CPACR, row.cpacr);
    if (!row.privileged) b.core.edit().set_control(1);
    run(b, 50);
    EXPECT_EQ(b.core.last_fault().cfsr, row.open ? 0 : fp_nocp) << std::hex << row.cpacr;
    EXPECT_EQ(b.core.reg(1), row.open ? 100u : 0u) << std::hex << row.cpacr;
    EXPECT_EQ((b.core.state().control & State::control_fpca) != 0, row.open);
  }
}

TEST_P(FpuContext, AnInstructionThatIsSkippedOpensNothing) {
  Bench b(0, cortex_m4f);
  prepare(b, {0x4280, 0xBF18, 0xEE10, 0x1A10,  // cmp r0,r0; it ne; vmovne r1,s0
              0xEE10, 0x2A90});                // vmov r2,s1
  write(b, ppb::CPACR, 0);
  run(b, 50);
  EXPECT_EQ(b.core.last_fault().cfsr, fp_nocp);
  EXPECT_EQ(b.core.last_fault().address, Bench::program + 8);
  EXPECT_EQ(b.core.reg(2), 0u);
}

// A5.3.18: in an open FPU the rest of its encodings is undefined, other coprocessors are none.
TEST_P(FpuContext, DoublePrecisionIsUndefined) {
  struct Row {
    const char* text;
    uint16_t first, second;
    uint32_t open, closed;
  };
  for (const Row& row : {Row{"vadd.f64 d0,d0,d1", 0xEE30, 0x0B01, fp_undefinstr, fp_nocp},
                         Row{"vldr d16,[r0]", 0xEDD0, 0x0B00, fp_undefinstr, fp_nocp},
                         Row{"vmrs r0,mvfr0", 0xEEF7, 0x0A10, fp_undefinstr, fp_nocp},
                         Row{"vsel.f32 s0,s0,s0", 0xFE00, 0x0A00, fp_undefinstr, fp_nocp},
                         Row{"mcr p15,0,r0,c7,c5,4", 0xEE07, 0x0F95, fp_nocp, fp_nocp},
                         Row{"ldc p9,c0,[r0]", 0xED90, 0x0900, fp_nocp, fp_nocp}}) {
    for (const bool is_open : {false, true}) {
      Bench b(0, cortex_m4f);
      prepare(b, {row.first, row.second});
      if (!is_open) write(b, ppb::CPACR, 0);
      run(b, 50);
      EXPECT_EQ(b.core.last_fault().cfsr, is_open ? row.open : row.closed) << row.text;
      EXPECT_EQ(b.core.state().control & State::control_fpca, 0u) << row.text;
    }
  }
}

TEST_P(FpuContext, TheCortexM4WithoutFpuHasNoneOfIt) {
  unsigned lines = 0;
  for (unsigned i = 0; i < encoding_count(); ++i) {
    const Encoding& line = encodings()[i];
    if (line.set != instruction_set::fpv4) continue;
    ++lines;
    for (const Profile* profile : {&cortex_m4, &cortex_m3}) {
      const auto first = static_cast<uint16_t>(line.value >> 16);
      const DecodedOp op = decode(0, first, static_cast<uint16_t>(line.value), 0, *profile);
      EXPECT_EQ(op.operation, Operation::coprocessor) << line.name;
    }
  }
  EXPECT_EQ(lines, 56u);
  Bench b(0, cortex_m4);
  choose(b.core, GetParam());
  b.start({0xF380, 0x8814, 0xF3EF, 0x8114, Bench::stay});  // msr control,r0; mrs r1,control
  b.core.set_reg(0, 4);
  write(b, ppb::CPACR, all_open);
  run(b, 50);
  EXPECT_EQ(b.core.reg(1), 0u) << "no FPCA";
  EXPECT_EQ(b.peek(ppb::CPACR), 0u);
  EXPECT_EQ(b.peek(ppb::FPCCR), 0u);
}

// ExecuteFPCheck
TEST_P(FpuContext, TheFirstInstructionBeginsAContext) {
  Bench b(0, cortex_m4f);
  // mrs r4,control; vmrs r2,fpscr; mrs r5,control; vmsr fpscr,r3; vmrs r6,fpscr
  prepare(b, {0xF3EF, 0x8414, 0xEEF1, 0x2A10, 0xF3EF, 0x8514, 0xEEE1, 0x3A10, 0xEEF1, 0x6A10});
  write(b, ppb::FPDSCR, 0xFFFFFFFF);
  b.core.set_reg(3, 0xFFFFFFFF);
  run(b, 50);
  EXPECT_EQ(b.core.reg(4), 0u);
  EXPECT_EQ(b.core.reg(2), 0x67C00000u) << "AHP, DN, FZ and RMode of FPDSCR; the flags stay";
  EXPECT_EQ(b.core.reg(5), 4u) << "FPCA";
  EXPECT_EQ(b.core.reg(6), 0xF7C0009Fu) << "what exists of FPSCR; no second context";
}
TEST_P(FpuContext, WithoutAspenThereAreNoContexts) {
  Bench b(0, cortex_m4f);
  prepare(b, {0xEEF1, 0x2A10, 0xF3EF, 0x8514});  // vmrs r2,fpscr; mrs r5,control
  write(b, ppb::FPDSCR, 0xFFFFFFFF);
  write(b, ppb::FPCCR, lspen);
  run(b, 50);
  EXPECT_EQ(b.core.reg(2), 0x60000000u);
  EXPECT_EQ(b.core.reg(5), 0u);
}
TEST_P(FpuContext, MsrWritesFpcaInHandlersToo) {
  Bench b(0, cortex_m4f);
  prepare(b, {0xDF00});
  // msr control,r0; mrs r1,control
  b.code(Bench::handler(exception::svcall), {0xF380, 0x8814, 0xF3EF, 0x8114, Bench::stay});
  b.core.set_reg(0, 6);
  run(b, 50);
  EXPECT_EQ(b.core.reg(1), 4u) << "SPSEL is Thread mode's";
}

// VMRS APSR_nzcv
TEST_P(FpuContext, AComparisonDecidesABranch) {
  Bench b(0, cortex_m4f);
  // vcmp.f32 s3,s1; vmrs APSR_nzcv,fpscr; it gt; movgt r0,#1
  prepare_context(b, {0xEEF4, 0x1A60, 0xEEF1, 0xFA10, 0xBFC8, 0x2001});
  run(b, 50);
  EXPECT_EQ(b.core.reg(0), 1u);
  EXPECT_EQ(b.core.state().xpsr() >> 28, 2u);
}

// B1.5.7: LSPEN, and a handler that does not use the FPU.
TEST_P(FpuContext, AHandlerWithoutFloatingPointCostsNothing) {
  Bench b(0, cortex_m4f);
  prepare_context(b, {0xDF00});  // svc
  // mov r5,lr; mov r6,sp; mrs r4,control; bx lr
  b.code(Bench::handler(exception::svcall), {0x4675, 0x466E, 0xF3EF, 0x8414, 0x4770});
  b.core.run(b.core.cycles() + 2);
  const uint32_t frame = Bench::stack - extended_frame_bytes;
  EXPECT_EQ(b.core.state().msp(), frame);
  EXPECT_EQ(b.core.cycles(), 2u + 12);
  EXPECT_EQ(b.peek(ppb::FPCCR),
            aspen | lspen | lspact | fpccr_thread | hfrdy);  // other faults are disabled
  EXPECT_EQ(b.peek(ppb::FPCAR), frame + exception_frame_bytes);
  run(b);
  EXPECT_EQ(b.core.reg(5), 0xFFFFFFE9u);
  EXPECT_EQ(b.core.reg(6), frame);
  EXPECT_EQ(b.core.reg(4), 0u) << "FPCA";
  EXPECT_EQ(b.core.state().msp(), Bench::stack);
  EXPECT_EQ(b.core.state().control, State::control_fpca);
  EXPECT_EQ(b.peek(ppb::FPCCR) & lspact, 0u);
  EXPECT_EQ(b.peek(frame + exception_frame_bytes), 0u) << "not stacked";
  expect_untouched(b);
}
TEST_P(FpuContext, FpccrSaysWhoCouldBeInterrupted) {
  struct Row {
    uint32_t shcsr, demcr, control;
    bool masked;
    uint32_t expected;
  };
  for (const Row& row : {Row{7u << 16, 0, 4, false, fpccr_thread | hfrdy | mmrdy | bfrdy},
                         Row{1u << 16, 0, 5, false, fpccr_thread | fpccr_user | hfrdy | mmrdy},
                         Row{2u << 16, 1u << 16, 4, false, fpccr_thread | hfrdy | bfrdy | mon_rdy},
                         Row{7u << 16, 1u << 16, 4, true, fpccr_thread | hfrdy}}) {
    Bench b(0, cortex_m4f);
    prepare_context(b, {0xBF00, 0xBF00});
    b.code(Bench::handler(exception::nmi), {Bench::stay});
    write(b, ppb::SHCSR, row.shcsr);
    write(b, ppb::DEMCR, row.demcr);
    b.core.edit().set_control(row.control);
    b.core.edit().set_primask(row.masked);
    b.core.pulse_nmi();
    b.core.run(b.core.cycles() + 2);
    EXPECT_EQ(b.peek(ppb::FPCCR), aspen | lspen | lspact | row.expected);
  }
}

// PreserveFPState
TEST_P(FpuContext, AHandlerThatUsesItSavesItFirst) {
  Bench b(0, cortex_m4f);
  prepare_context(b, {0xDF00});
  // vmov.f32 s0,#1.0; vmov s1,r1; vmov s16,r0; vmsr fpscr,r3; mov r5,lr; bx lr
  b.code(Bench::handler(exception::svcall),
         {0xEEB7, 0x0A00, 0xEE00, 0x1A90, 0xEE08, 0x0A10, 0xEEE1, 0x3A10, 0x4675, 0x4770});
  b.core.set_reg(0, 116);
  b.core.set_reg(3, 0x9F);
  run(b);
  const uint32_t saved = Bench::stack - extended_frame_bytes + exception_frame_bytes;
  for (unsigned n = 0; n < Fpu::stacked; ++n) EXPECT_EQ(b.peek(saved + 4 * n), 100 + n);
  EXPECT_EQ(b.peek(saved + 64), 0x60000000u) << "FPSCR";
  EXPECT_EQ(b.core.reg(5), 0xFFFFFFE9u);
  EXPECT_EQ(b.core.state().msp(), Bench::stack);
  EXPECT_EQ(b.core.state().control, State::control_fpca);
  EXPECT_EQ(b.peek(ppb::FPCCR) & lspact, 0u);
  expect_untouched(b);
}
TEST_P(FpuContext, TheCallersOwnRegistersStayAsTheHandlerLeavesThem) {
  Bench b(0, cortex_m4f);
  prepare_context(b, {0xDF00});
  b.code(Bench::handler(exception::svcall), {0xEE08, 0x0A10, 0x4770});  // vmov s16,r0
  b.core.set_reg(0, 7);
  run(b);
  EXPECT_EQ(b.core.state().fpu.s(16), 7u);
  EXPECT_EQ(b.core.state().fpu.s(15), 115u);
}
TEST_P(FpuContext, AHandlersContextBeginsWithFpdscr) {
  Bench b(0, cortex_m4f);
  prepare_context(b, {0xDF00});
  b.code(Bench::handler(exception::svcall), {0xEEF1, 0x2A10, 0x4770});  // vmrs r2,fpscr
  // r2 is of the frame: str r2,[r4] before
  b.code(Bench::handler(exception::svcall), {0xEEF1, 0x2A10, 0x6022, 0x4770});
  b.core.set_reg(4, Bench::ram_base);
  write(b, ppb::FPDSCR, 3u << 22);
  run(b);
  EXPECT_EQ(b.peek(Bench::ram_base), 0x60C00000u);
  expect_untouched(b);
}
TEST_P(FpuContext, NestedHandlersUseItOneInTheOther) {
  Bench b(0, cortex_m4f);
  prepare_context(b, {0xDF00});
  // SVCall: vmov s1,r1; str r4,[r4,#4]: NMI; vmov r7,s1; str r7,[r5]; bx lr
  b.code(Bench::handler(exception::svcall),
         {0xEE00, 0x1A90, 0x6063, 0xBF00, 0xEE10, 0x7A90, 0x602F, 0x4770});
  // NMI: vmov s1,r2; bx lr
  b.code(Bench::handler(exception::nmi), {0xEE00, 0x2A90, 0x4770});
  b.core.set_reg(1, 1);
  b.core.set_reg(2, 2);
  b.core.set_reg(3, 1u << 31);
  b.core.set_reg(4, ppb::CPUID);
  b.core.set_reg(5, Bench::ram_base);
  run(b);
  EXPECT_EQ(b.peek(Bench::ram_base), 1u) << "of SVCall, after NMI";
  EXPECT_EQ(b.core.state().msp(), Bench::stack);
  expect_untouched(b);
}
TEST_P(FpuContext, ATailChainedHandlerFindsTheSameFrame) {
  Bench b(0, cortex_m4f);
  prepare_context(b, {0xDF00});
  // SVCall: str r3,[r4,#4]: PendSV; vmov s0,r3; bx lr
  b.code(Bench::handler(exception::svcall), {0x6063, 0xEE00, 0x3A10, 0x4770});
  // PendSV: mov r5,lr; mrs r6,control; vmov s1,r3; bx lr
  b.code(Bench::handler(exception::pendsv), {0x4675, 0xF3EF, 0x8614, 0xEE00, 0x3A90, 0x4770});
  b.core.set_reg(3, 1u << 28);
  b.core.set_reg(4, ppb::CPUID);
  run(b);
  EXPECT_EQ(b.core.reg(5), 0xFFFFFFE9u);
  EXPECT_EQ(b.core.reg(6), 0u) << "FPCA: a new context";
  expect_untouched(b);
}

TEST_P(FpuContext, WithoutLspenEntryStacksEverything) {
  Bench b(0, cortex_m4f);
  prepare_context(b, {0xDF00});
  write(b, ppb::FPCCR, aspen);
  b.code(Bench::handler(exception::svcall), {0xBF00, 0x4770});
  b.core.run(b.core.cycles() + 2);
  EXPECT_EQ(b.core.cycles(), 2u + 12 + 17);
  const uint32_t saved = Bench::stack - extended_frame_bytes + exception_frame_bytes;
  for (unsigned n = 0; n < Fpu::stacked; ++n) EXPECT_EQ(b.peek(saved + 4 * n), 100 + n);
  EXPECT_EQ(b.peek(saved + 64), 0x60000000u);
  EXPECT_EQ(b.peek(ppb::FPCCR), aspen);
  b.core.edit().fpu.set_s(3, 0);
  run(b);
  EXPECT_EQ(b.core.state().msp(), Bench::stack);
  expect_untouched(b);
}
TEST_P(FpuContext, WithoutLspenAClosedFpuCannotBeStacked) {
  Bench b(0, cortex_m4f);
  prepare_context(b, {0xDF00});
  write(b, ppb::FPCCR, aspen);
  write(b, ppb::CPACR, 0);
  run(b);
  EXPECT_EQ(b.core.last_fault().cfsr, fp_nocp);
  EXPECT_EQ(b.core.state().ipsr, unsigned{exception::hard_fault});
}

// B1.5.6: forcealign
TEST_P(FpuContext, AnExtendedFrameIsAlignedWhateverCcrSays) {
  for (const bool extended : {false, true}) {
    Bench b(0, cortex_m4f);
    prepare(b, {0xB081, 0xDF00});  // sub sp,#4; svc
    if (extended) b.core.edit().set_control(State::control_fpca);
    write(b, ppb::CCR, 0);
    b.code(Bench::handler(exception::svcall), {0x466E, 0x9F07, 0x4770});  // mov r6,sp
    run(b);
    const uint32_t sp = Bench::stack - 4;
    EXPECT_EQ(b.core.reg(6), extended ? (sp - 0x68) & ~7u : sp - 0x20);
    EXPECT_EQ((b.core.reg(7) & 1u << 9) != 0, extended) << "xPSR in the frame";
    EXPECT_EQ(b.core.reg(13), sp);
  }
}

// B1.5.8
TEST_P(FpuContext, AReturnFromABasicFrameEndsTheContext) {
  Bench b(0, cortex_m4f);
  prepare(b, {0xDF00});
  b.code(Bench::handler(exception::svcall), {0xEEB7, 0x0A00, 0x4675, 0x4770});  // vmov s0,#1.0
  run(b);
  EXPECT_EQ(b.core.reg(5), 0xFFFFFFF9u);
  EXPECT_EQ(b.core.state().control, 0u);
  EXPECT_EQ(b.core.state().fpu.s(0), 0x3F800000u);
}
TEST_P(FpuContext, OnlyAnFpuHasExtendedFrames) {
  for (const Profile* profile : {&cortex_m4, &cortex_m4f}) {
    for (const uint32_t exc_return : {0xFFFFFFE9u, 0xFFFFFFD9u}) {
      Bench b(0, *profile);
      choose(b.core, GetParam());
      b.code(Bench::handler(exception::svcall), {0x4720});  // bx r4
      b.code(Bench::handler(exception::hard_fault), {Bench::stay});
      b.start({0xDF00, Bench::stay});
      write(b, ppb::CPACR, all_open);
      b.core.set_reg(4, exc_return);
      run(b, 200);
      const bool good = profile == &cortex_m4f && exc_return == 0xFFFFFFE9;
      EXPECT_EQ(b.core.first_fault().cfsr, good ? 0u : fp_invpc) << profile->name;
    }
  }
}
TEST_P(FpuContext, AStackOfAProcessHasExtendedFrames) {
  Bench b(0, cortex_m4f);
  prepare(b, {0xDF00});
  b.core.edit().set_control(State::control_fpca | 2);
  b.core.edit().set_psp(Bench::ram_base + 0x1000);
  b.code(Bench::handler(exception::svcall), {0x4675, 0xEE00, 0x1A10, 0x4770});
  run(b);
  EXPECT_EQ(b.core.reg(5), 0xFFFFFFEDu);
  EXPECT_EQ(b.core.state().psp(), Bench::ram_base + 0x1000);
  EXPECT_EQ(b.peek(Bench::ram_base + 0x1000 - 0x48), 100u);
  EXPECT_EQ(b.core.state().control, 6u);
  expect_untouched(b);
}

// B1.5.7: faults of a save that is due
TEST_P(FpuContext, AFaultOfTheSaveIsTakenBeforeTheInstruction) {
  Bench b(0, cortex_m4f);
  prepare_context(b, {0xDF00});
  const uint32_t frame = Bench::stack - extended_frame_bytes;
  b.code(Bench::handler(exception::svcall), {0xBF00, 0xEE00, 0x1A10, 0x3701, 0x4770});
  // MemManage: str r4,[r5] switches the MPU off, and it continues
  b.code(Bench::handler(exception::mem_manage), {0x602C, 0x4770});
  b.core.set_reg(5, ppb::MPU_CTRL);
  write(b, ppb::SHCSR, 1u << 16);
  write(b, ppb::SHPR + 4, 0x80000000);  // SVCall below MemManage
  b.core.run(b.core.cycles() + 2);
  protect(b, frame + 0x40, 32);
  run(b);
  EXPECT_EQ(b.core.fault_count(), 1u);
  EXPECT_EQ(b.core.last_fault().kind, FaultReport::Kind::mem_manage);
  EXPECT_EQ(b.core.last_fault().cfsr, mlsperr) << "no address";
  EXPECT_EQ(b.core.last_fault().registers.r[15], Bench::handler(exception::svcall) + 2);
  EXPECT_EQ(b.core.reg(7), 1u);
  EXPECT_EQ(b.peek(frame + 0x40), 108u) << "saved when the instruction was repeated";
  expect_untouched(b);
}
TEST_P(FpuContext, TheInstructionIsRepeatedInItsItBlock) {
  Bench b(0, cortex_m4f);
  prepare_context(b, {0xDF00});
  // cmp r0,r0; ite eq; vmoveq s0,r1; addne r7,#1; vmov r6,s0; bx lr
  b.code(Bench::handler(exception::svcall),
         {0x4280, 0xBF0C, 0xEE00, 0x1A10, 0x3701, 0xEE10, 0x6A10, 0x4770});
  b.code(Bench::handler(exception::mem_manage), {0x602C, 0x4770});
  b.core.set_reg(1, 9);
  b.core.set_reg(5, ppb::MPU_CTRL);
  write(b, ppb::SHCSR, 1u << 16);
  write(b, ppb::SHPR + 4, 0x80000000);
  b.core.run(b.core.cycles() + 2);
  protect(b, Bench::stack - extended_frame_bytes + 0x40, 32);
  run(b);
  EXPECT_EQ(b.core.last_fault().cfsr, mlsperr);
  EXPECT_EQ(b.core.reg(6), 9u);
  EXPECT_EQ(b.core.reg(7), 0u);
}
TEST_P(FpuContext, AFaultThatTheContextCouldNotHaveTakenEscalates) {
  Bench b(0, cortex_m4f);
  prepare_context(b, {0xDF00});  // MemManage is disabled: MMRDY is clear
  b.code(Bench::handler(exception::svcall), {0xBF00, 0xEE00, 0x1A10, 0x4770});
  b.core.run(b.core.cycles() + 2);
  write(b, ppb::SHCSR, 1u << 16);
  protect(b, Bench::stack - extended_frame_bytes, 128);
  run(b);
  EXPECT_EQ(b.core.last_fault().kind, FaultReport::Kind::hard_fault);
  EXPECT_EQ(b.core.last_fault().cfsr, mlsperr);
  EXPECT_EQ(b.core.last_fault().hfsr, 1u << 30) << "FORCED";
  EXPECT_NE(b.peek(ppb::FPCCR) & lspact, 0u) << "still due";
}
TEST_P(FpuContext, AFaultThatMayNotPreemptComesAfterTheHandler) {
  Bench b(0, cortex_m4f);
  prepare_context(b, {0xBF00, 0xBF00});
  write(b, ppb::SHCSR, 1u << 16);
  b.code(Bench::handler(exception::nmi), {0xBF00, 0xEE00, 0x1A10, 0x4604, 0x4770});
  b.core.pulse_nmi();
  b.core.run(b.core.cycles() + 2);
  protect(b, Bench::stack - extended_frame_bytes, 128);
  b.core.set_reg(0, 77);
  run(b);
  EXPECT_EQ(b.core.reg(4), 77u) << "NMI went on";
  EXPECT_EQ(b.core.last_fault().kind, FaultReport::Kind::mem_manage);
  EXPECT_EQ(b.core.last_fault().cfsr & mlsperr, mlsperr);
  EXPECT_EQ(b.peek(ppb::FPCCR) & lspact, 0u) << "the state is lost";
}
TEST_P(FpuContext, ABusErrorOfTheSave) {
  Bench b(0, cortex_m4f);
  prepare_context(b, {0xDF00});
  b.code(Bench::handler(exception::svcall), {0xBF00, 0xEE00, 0x1A10, 0x4770});
  write(b, ppb::SHCSR, 2u << 16);
  write(b, ppb::SHPR + 4, 0x80000000);
  b.core.run(b.core.cycles() + 2);
  write(b, ppb::FPCAR, 0x60000000);
  run(b);
  EXPECT_EQ(b.core.last_fault().kind, FaultReport::Kind::bus_fault);
  EXPECT_EQ(b.core.last_fault().cfsr, lsperr);
}
TEST_P(FpuContext, WhatNotEvenHardFaultCouldPreemptLocksUp) {
  Bench b(0, cortex_m4f);
  prepare_context(b, {0xBF00, 0xBF00});
  b.core.edit().set_faultmask(true);
  b.code(Bench::handler(exception::nmi), {0xBF00, 0xEE00, 0x1A10, 0x4770});
  b.core.pulse_nmi();
  b.core.run(b.core.cycles() + 2);
  EXPECT_EQ(b.peek(ppb::FPCCR) & hfrdy, 0u);
  write(b, ppb::FPCAR, 0x60000000);
  EXPECT_EQ(b.core.run(b.core.cycles() + 100), StopReason::lockup);
  EXPECT_EQ(b.core.last_fault().cfsr, lsperr);
}
// The accesses have the privilege of the context, and its priority at the MPU (HFNMIENA).
TEST_P(FpuContext, TheSaveHasThePrivilegeOfTheContext) {
  for (const bool user : {false, true}) {
    Bench b(0, cortex_m4f);
    prepare(b, {0xDF00});
    b.core.edit().set_control(State::control_fpca | (user ? 3u : 2u));
    b.core.edit().set_psp(Bench::ram_base + 0x1000);
    b.code(Bench::handler(exception::svcall), {0xBF00, 0xEE00, 0x1A10, 0x3701, 0x4770});
    b.core.run(b.core.cycles() + 2);
    protect(b, Bench::ram_base + 0xF80, 128, 1);  // for privileged accesses only
    run(b, 60);
    EXPECT_EQ(b.core.first_fault().cfsr & mlsperr, user ? mlsperr : 0u) << user;
  }
}
TEST_P(FpuContext, FaultsOfStackingAndUnstackingWithoutLspen) {
  for (const bool unstacking : {false, true}) {
    Bench b(0, cortex_m4f);
    prepare(b, {0xDF00});
    b.core.edit().set_control(State::control_fpca | 2);
    b.core.edit().set_psp(Bench::ram_base + 0x1000);
    write(b, ppb::FPCCR, aspen);
    write(b, ppb::SHCSR, 1u << 16);
    b.code(Bench::handler(exception::svcall), {0xBF00, 0x4770});
    if (unstacking) b.core.run(b.core.cycles() + 2);
    protect(b, Bench::ram_base + 0xFC0, 64, unstacking ? 0 : 5);  // after the basic frame
    run(b);
    EXPECT_EQ(b.core.first_fault().cfsr, unstacking ? munstkerr : mstkerr);
  }
}

// A3.2.1
TEST_P(FpuContext, TransfersAreAligned) {
  struct Row {
    const char* text;
    uint16_t first, second;
  };
  for (const Row& row :
       {Row{"vldr s2,[r0,#4]", 0xED90, 0x1A01}, Row{"vstr s2,[r0,#4]", 0xED80, 0x1A01},
        Row{"vldr d1,[r0,#4]", 0xED90, 0x1B01}, Row{"vldm r0,{s0-s7}", 0xEC90, 0x0A08},
        Row{"vstm r0!,{d0-d3}", 0xECA0, 0x0B08}}) {
    Bench b(0, cortex_m4f);
    prepare(b, {row.first, row.second});
    b.core.set_reg(0, Bench::ram_base + 2);
    run(b, 60);
    EXPECT_EQ(b.core.last_fault().cfsr, fp_unaligned) << row.text;
    EXPECT_EQ(b.core.reg(0), Bench::ram_base + 2) << row.text;
  }
}
TEST_P(FpuContext, ATransferThatFaultsChangesNothing) {
  Bench b(0, cortex_m4f);
  prepare_context(b, {0xECB0, 0x0A08});  // vldmia r0!,{s0-s7}
  b.core.set_reg(0, Bench::ram_base + 65536 - 16);
  run(b, 60);
  EXPECT_EQ(b.core.last_fault().cfsr & 0xFF00, 0x8200u) << "PRECISERR, BFARVALID";
  EXPECT_EQ(b.core.reg(0), Bench::ram_base + 65536 - 16);
  expect_untouched(b);
}

// What unpredictable.def says of fp_operands
TEST_P(FpuContext, ARegisterThatThereIsNotReadsAsZero) {
  Bench b(0, cortex_m4f);
  std::vector<Unpredictable> told;
  b.core.listeners().unpredictable = [&](Unpredictable which, uint32_t) { told.push_back(which); };
  // vstmia r0!,{s30,s31,-,-}; vmov r1,r2,s31,-; vldmia r0!,{s31,-}
  prepare_context(b, {0xECA0, 0xFA04, 0xEC52, 0x1A3F, 0xECF0, 0xFA02});
  b.core.set_reg(0, Bench::ram_base);
  b.core.set_reg(2, 5);
  std::memset(b.ram.data(), 0x55, 32);
  run(b, 60);
  EXPECT_EQ(b.peek(Bench::ram_base + 4), 131u);
  EXPECT_EQ(b.peek(Bench::ram_base + 8), 0u);
  EXPECT_EQ(b.core.reg(1), 131u);
  EXPECT_EQ(b.core.reg(2), 0u);
  EXPECT_EQ(b.core.state().fpu.s(31), 0x55555555u);
  EXPECT_EQ(b.core.reg(0), Bench::ram_base + 24);
  EXPECT_EQ(told, std::vector<Unpredictable>{Unpredictable::fp_operands});
}

TEST_P(FpuContext, ACheckpointHasAllOfIt) {
  Bench b(0, cortex_m4f);
  prepare_context(b, {0xDF00});
  b.code(Bench::handler(exception::svcall), {0xBF00, 0xBF00, 0xBF00, 0xEE00, 0x1A10, 0x4770});
  write(b, ppb::FPDSCR, 0x07C00000);
  b.core.run(b.core.cycles() + 3);
  StateWriter saved;
  b.core.visit(saved);
  const std::string bytes = saved.take();
  Bench other(0, cortex_m4f);
  prepare(other, {0xDF00});
  other.code(Bench::handler(exception::svcall), {0xBF00, 0xBF00, 0xBF00, 0xEE00, 0x1A10, 0x4770});
  StateReader reader(bytes);
  other.core.visit(reader);
  EXPECT_TRUE(reader.ok() && reader.at_end()) << reader.problem();
  other.ram = b.ram;
  for (Bench* each : {&b, &other}) run(*each);
  EXPECT_EQ(other.core.cycles(), b.core.cycles());
  EXPECT_EQ(other.ram, b.ram);
  expect_untouched(other);
  EXPECT_EQ(other.peek(ppb::FPDSCR), 0x07C00000u);
  Bench without(0, cortex_m4);
  StateReader for_another(bytes);
  without.core.visit(for_another);
  EXPECT_FALSE(for_another.ok() && for_another.at_end());
}

// DDI 0439D, table 7-1
TEST_P(FpuContext, TakesTheTimesOfItsManual) {
  struct Row {
    const char* text;
    std::initializer_list<uint16_t> code;
    unsigned cycles;
  };
  for (const Row& row :
       {Row{"vadd.f32 s0,s0,s1", {0xEE30, 0x0A20}, 1}, Row{"vabs.f32 s3,s2", {0xEEF0, 0x1AC1}, 1},
        Row{"vcmp.f32 s3,s1", {0xEEF4, 0x1A60}, 1}, Row{"vcvt.s32.f32 s3,s1", {0xEEFD, 0x1AE0}, 1},
        Row{"vmla.f32 s3,s1,s2", {0xEE40, 0x1A81}, 3},
        Row{"vfma.f32 s3,s1,s2", {0xEEE0, 0x1A81}, 3},
        Row{"vdiv.f32 s3,s1,s2", {0xEEC0, 0x1A81}, 14},
        Row{"vsqrt.f32 s3,s1", {0xEEF1, 0x1AE0}, 14}, Row{"vmov r1,s0", {0xEE10, 0x1A10}, 1},
        Row{"vmov d1,r0,r1", {0xEC41, 0x0B11}, 2}, Row{"vmrs r2,fpscr", {0xEEF1, 0x2A10}, 1},
        Row{"vldr s2,[r0,#4]", {0xED90, 0x1A01}, 2}, Row{"vldr d1,[r0,#4]", {0xED90, 0x1B01}, 3},
        Row{"vstr s2,[r0,#4]", {0xED80, 0x1A01}, 2}, Row{"vldm r0,{s0-s7}", {0xEC90, 0x0A08}, 9},
        Row{"vstm r0!,{d0-d3}", {0xECA0, 0x0B08}, 9}})
    EXPECT_EQ(cycles_of(row.code), row.cycles) << row.text;
}
// 17 words more where the save is made, and where a return takes them back.
TEST_P(FpuContext, ASaveTakes17Cycles) {
  const auto cycles = [this](std::initializer_list<uint16_t> handler) {
    Bench b(0, cortex_m4f);
    prepare_context(b, {0xDF00});
    b.code(Bench::handler(exception::svcall), handler);
    while (b.core.reg(15) != Bench::program + 2 && b.core.cycles() < 100)
      b.core.run(b.core.cycles() + 1);
    return b.core.cycles();
  };
  const uint64_t without = cycles({0xF3AF, 0x8000, 0x4770});  // nop.w
  EXPECT_EQ(cycles({0xEE30, 0x0A20, 0x4770}), without + 2 * 17) << "vadd";
}

}  // namespace
}  // namespace capsoc::armv7m::test
