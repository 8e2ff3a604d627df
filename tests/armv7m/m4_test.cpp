// What the Cortex-M4 without FPU has beyond the Cortex-M3 (ARM DDI 0403, the DSP extension; DDI
// 0439, its TRM), in every executor.
#include <gtest/gtest.h>

#include <cstdint>
#include <initializer_list>
#include <vector>

#include "armv7m/isa/decoder.h"
#include "armv7m/system/registers.h"
#include "base/archive.h"
#include "bench.h"
#include "executors.h"

namespace capsoc::armv7m::test {
namespace {

constexpr uint32_t ge = 0x000F0000, nzcvq = 0xF8000000;
constexpr uint32_t undefinstr = 1u << 16, nocp = 1u << 19;

class M4 : public testing::TestWithParam<Executor> {
 protected:
  /// Executes `code` and stays past it, or in a handler. `values`: of r0 and on.
  void run(Bench& b, std::initializer_list<uint16_t> code,
           std::initializer_list<uint32_t> values = {}) const {
    choose(b.core, GetParam());
    b.code(Bench::handler(exception::hard_fault), {Bench::stay});
    b.start(code);
    b.code(Bench::program + 2 * static_cast<uint32_t>(code.size()), {Bench::stay});
    unsigned n = 0;
    for (const uint32_t value : values) b.core.set_reg(n++, value);
    b.core.run(b.core.cycles() + 200);
  }
  uint64_t cycles_of(const Profile& profile, std::initializer_list<uint16_t> code) const {
    Bench b(0, profile);
    choose(b.core, GetParam());
    b.start(code);
    const uint32_t end = Bench::program + 2 * static_cast<uint32_t>(code.size());
    b.code(end, {Bench::stay});
    for (unsigned n = 0; n < 8; ++n) b.core.set_reg(n, 0x20000100 + 0x1000 * n);
    b.core.run(b.core.cycles() + 1);
    while (b.core.reg(15) != end && b.core.cycles() < 60) b.core.run(b.core.cycles() + 1);
    EXPECT_EQ(b.core.fault_count(), 0u);
    return b.core.cycles();
  }
};

INSTANTIATE_TEST_SUITE_P(Executors, M4, testing::ValuesIn(all_executors), executor_name);

// DDI 0439D, table 4-1.
TEST_P(M4, SaysWhatItIs) {
  Bench b(0, cortex_m4);
  // ldr r0,[r0]; ldrd r2,r3,[r1]; ldrd r4,r5,[r1,#8]
  run(b, {0x6800, 0xE9D1, 0x2300, 0xE9D1, 0x4502}, {ppb::CPUID, ppb::ID_ISAR0});
  EXPECT_EQ(b.core.reg(0), 0x410FC241u);
  EXPECT_EQ(b.core.reg(2), 0x01141110u);
  EXPECT_EQ(b.core.reg(3), 0x02112000u);
  EXPECT_EQ(b.core.reg(4), 0x21232231u);
  EXPECT_EQ(b.core.reg(5), 0x01111131u);
}

// A5.3: the Cortex-M3 has none of it.
TEST_P(M4, TheDspExtensionIsUndefinedToTheCortexM3) {
  unsigned lines = 0;
  for (unsigned i = 0; i < encoding_count(); ++i) {
    const Encoding& line = encodings()[i];
    if (line.set != instruction_set::v7em) continue;
    ++lines;
    const auto first = static_cast<uint16_t>(line.value >> 16);
    const auto second = static_cast<uint16_t>(line.value);
    EXPECT_EQ(decode(0, first, second, 0, cortex_m4).operation, line.operation) << line.name;
    Bench b;
    run(b, {first, second});
    EXPECT_EQ(b.core.last_fault().cfsr, undefinstr) << line.name;
    EXPECT_EQ(b.core.fault_count(), 1u) << line.name;
  }
  EXPECT_EQ(lines, 70u);
}

// B5.2.3: bit 1 of the mask for N, Z, C, V and Q, bit 0 for GE.
TEST_P(M4, MsrWritesTheFlagsThatItsMaskNames) {
  struct Row {
    uint16_t mask;
    uint32_t written;
  };
  for (const Row& row : {Row{0x8400, ge}, Row{0x8800, nzcvq}, Row{0x8C00, nzcvq | ge}}) {
    Bench b(0, cortex_m4);
    std::vector<Unpredictable> told;
    b.core.listeners().unpredictable = [&](Unpredictable which, uint32_t) {
      told.push_back(which);
    };
    // msr apsr, r0; mrs r2, apsr; msr apsr_nzcvqg, r0; msr apsr, r1; mrs r3, apsr
    run(b, {0xF380, row.mask, 0xF3EF, 0x8200, 0xF380, 0x8C00, 0xF381, row.mask, 0xF3EF, 0x8300},
        {~0u, 0});
    EXPECT_EQ(b.core.reg(2), row.written);
    EXPECT_EQ(b.core.reg(3), (nzcvq | ge) & ~row.written);
    EXPECT_TRUE(told.empty()) << row.mask;
  }
}
TEST_P(M4, TheCortexM3HasNoGe) {
  Bench b;
  std::vector<Unpredictable> told;
  b.core.listeners().unpredictable = [&](Unpredictable which, uint32_t) { told.push_back(which); };
  run(b, {0xF380, 0x8C00, 0xF3EF, 0x8200}, {~0u});
  EXPECT_EQ(b.core.reg(2), nzcvq);
  EXPECT_EQ(told, std::vector<Unpredictable>{Unpredictable::special_name});
  EXPECT_EQ(b.core.state().xpsr() & ge, 0u);
}

// B1.5.6, B1.5.8: the frame has the whole xPSR.
TEST_P(M4, AnExceptionStacksAndUnstacksGe) {
  Bench b(0, cortex_m4);
  // ldr r5,[sp,#28]; uadd8 r6,r7,r7 (clears GE); bx lr
  b.code(Bench::handler(exception::svcall), {0x9D07, 0xFA87, 0xF647, 0x4770});
  // msr apsr_g, r0; svc; sel r2,r3,r4
  run(b, {0xF380, 0x8400, 0xDF00, 0xFAA3, 0xF284}, {0x00050000, 0, 0, 0x11223344, 0x55667788});
  EXPECT_EQ(b.core.reg(5) & ge, 0x00050000u);
  EXPECT_EQ(b.core.reg(2), 0x55227744u);
  EXPECT_EQ(b.core.state().xpsr() & ge, 0x00050000u);
}
TEST_P(M4, AReturnTakesGeFromTheFrame) {
  for (const Profile* profile : {&cortex_m3, &cortex_m4}) {
    Bench b(0, *profile);
    // ldr r5,[sp,#28]; orrs r5,r6; str r5,[sp,#28]; bx lr
    b.code(Bench::handler(exception::svcall), {0x9D07, 0x4335, 0x9507, 0x4770});
    run(b, {0xDF00}, {0, 0, 0, 0, 0, 0, ge});
    EXPECT_EQ(b.core.fault_count(), 0u);
    EXPECT_EQ(b.core.state().xpsr() & ge, profile == &cortex_m4 ? ge : 0u) << profile->name;
  }
}

TEST_P(M4, ACheckpointKeepsGe) {
  Bench b(0, cortex_m4);
  run(b, {0xF380, 0x8C00}, {0x080A0000});
  StateWriter saved;
  State state = b.core.state();
  saved("cpu", state);
  const std::string bytes = saved.take();
  Bench other(0, cortex_m4);
  State restored = other.core.state();
  StateReader reader(bytes);
  reader("cpu", restored);
  EXPECT_TRUE(reader.ok() && reader.at_end()) << reader.problem();
  EXPECT_EQ(restored.xpsr(), b.core.state().xpsr());
  EXPECT_EQ(restored.xpsr() & (nzcvq | ge), 0x080A0000u);
  restored.reset(armv7m_registers);
  EXPECT_EQ(restored.xpsr() & ge, 0u);
}

// B1.5.13, B3.2.20: no coprocessor, and nothing to enable one.
TEST_P(M4, FloatingPointIsACoprocessorThatIsNotThere) {
  struct Row {
    const char* text;
    uint16_t first, second;
  };
  for (const Row& row :
       {Row{"vmov s0, r0", 0xEE00, 0x0A10}, Row{"vadd.f32 s0, s0, s0", 0xEE30, 0x0A00},
        Row{"vldr s0, [r0]", 0xED90, 0x0A00}, Row{"vpush {s0}", 0xED2D, 0x0A01}}) {
    Bench b(0, cortex_m4);
    // str r0,[r1] of CPACR; ldr r2,[r1]; ldr r4,[r3] of FPCCR
    run(b, {0x6008, 0x680A, 0x681C, row.first, row.second},
        {0x00F00000, 0xE000ED88, 1, 0xE000EF34, 1});
    EXPECT_EQ(b.core.reg(2), 0u) << "CPACR";
    EXPECT_EQ(b.core.reg(4), 0u) << "FPCCR";
    EXPECT_EQ(b.core.last_fault().cfsr, nocp) << row.text;
    EXPECT_EQ(b.core.last_fault().kind, FaultReport::Kind::hard_fault) << row.text;
    EXPECT_EQ(b.core.last_fault().registers.r[15], Bench::program + 6) << row.text;
  }
}
TEST_P(M4, AnEnabledUsageFaultTellsOfTheMissingCoprocessor) {
  Bench b(0, cortex_m4);
  b.code(Bench::handler(exception::usage_fault), {Bench::stay});
  run(b, {0x6008, 0xEE00, 0x0A10}, {0x00040000, ppb::SHCSR});
  EXPECT_EQ(b.core.state().ipsr, unsigned{exception::usage_fault});
  EXPECT_EQ(b.core.last_fault().cfsr, nocp);
}

// DDI 0439D, tables 3-1 and 3-2.
TEST_P(M4, MultipliesInOneCycle) {
  struct Row {
    const char* text;
    std::initializer_list<uint16_t> code;
    unsigned cycles, on_m3;  // 0: not there
  };
  const Row rows[] = {
      {"mul r0,r1,r2", {0xFB01, 0xF002}, 1, 1},
      {"mla r0,r1,r2,r3", {0xFB01, 0x3002}, 1, 2},
      {"mls r0,r1,r2,r3", {0xFB01, 0x3012}, 1, 2},
      {"smull r0,r3,r1,r2", {0xFB81, 0x0302}, 1, 5},
      {"umull r0,r3,r1,r2", {0xFBA1, 0x0302}, 1, 5},
      {"smlal r0,r3,r1,r2", {0xFBC1, 0x0302}, 1, 7},
      {"umlal r0,r3,r1,r2", {0xFBE1, 0x0302}, 1, 7},
      {"udiv r0,r1,r2", {0xFBB1, 0xF0F2}, 2, 2},
      {"smlad r0,r1,r2,r3", {0xFB21, 0x3002}, 1, 0},
      {"smlald r0,r3,r1,r2", {0xFBC1, 0x03C2}, 1, 0},
      {"umaal r0,r3,r1,r2", {0xFBE1, 0x0362}, 1, 0},
      {"smmlar r0,r1,r2,r3", {0xFB51, 0x3012}, 1, 0},
      {"usada8 r0,r1,r2,r3", {0xFB71, 0x3002}, 1, 0},
      {"sadd16 r0,r1,r2", {0xFA91, 0xF002}, 1, 0},
      {"sel r0,r1,r2", {0xFAA1, 0xF082}, 1, 0},
      {"qdadd r0,r2,r1", {0xFA81, 0xF092}, 1, 0},
      {"ssat16 r0,#4,r1", {0xF321, 0x0003}, 1, 0},
      {"pkhbt r0,r1,r2", {0xEAC1, 0x0002}, 1, 0},
      {"sxtab r0,r1,r2", {0xFA41, 0xF082}, 1, 0},
      {"ldr r0,[r1]; ldr r2,[r3]: pipelined", {0x6808, 0x681A}, 3, 3},
      {"str r0,[r1]", {0x6008}, 1, 1},
      {"ldm r1,{r0,r2,r3}", {0xE891, 0x000D}, 4, 4},
      {"b", {0xE7FF}, 2, 2},
      {"nop; it eq: folded", {0xBF00, 0xBF08, 0xBF00}, 2, 2},
  };
  for (const Row& row : rows) {
    EXPECT_EQ(cycles_of(cortex_m4, row.code), row.cycles) << row.text;
    if (row.on_m3 != 0) {
      EXPECT_EQ(cycles_of(cortex_m3, row.code), row.on_m3) << row.text;
    }
  }
}
// The register bank has no way from a result to an address for any data processing.
TEST_P(M4, AnAddressThatWasJustComputedStallsOneCycle) {
  // uxtab16 r1,r1,r2; ldr r0,[r1], with r2 = 0; the same with another base
  Bench same(0, cortex_m4), other(0, cortex_m4);
  for (Bench* b : {&same, &other}) {
    choose(b->core, GetParam());
    b->start({0xFA31, 0xF182, b == &same ? uint16_t{0x6808} : uint16_t{0x6818}, Bench::stay});
    b->core.set_reg(1, Bench::ram_base);
    b->core.set_reg(3, Bench::ram_base);
    while (b->core.reg(15) != Bench::program + 6 && b->core.cycles() < 60)
      b->core.run(b->core.cycles() + 1);
  }
  EXPECT_EQ(other.core.cycles(), 3u);
  EXPECT_EQ(same.core.cycles(), 4u);
}

}  // namespace
}  // namespace capsoc::armv7m::test
