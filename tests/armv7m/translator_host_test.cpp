// The translator and its host: a buffer that is always full, memory that may not be executed, a
// processor without BMI, and what is reported of each translation.
#include <gtest/gtest.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "bench.h"
#include "executors.h"

namespace capsoc::armv7m::test {
namespace {

constexpr uint32_t first_block = 0x8000, block_bytes = 32, block_count = 960;

/// Many small blocks that lead to each other in a random order, near and far, without an end.
void prepare_many_blocks(Bench& b) {
  std::vector<uint32_t> order(block_count);
  std::iota(order.begin(), order.end(), 0u);
  std::mt19937 random(1);
  std::shuffle(order.begin() + 1, order.end(), random);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const uint32_t at = first_block + block_bytes * order[i];
    const uint32_t next = first_block + block_bytes * order[(i + 1) % order.size()];
    // adds r0,#n; eors r1,r0; str r1,[r7]; ldr r2,[r7]; adds r3,r3,r2; b.w next
    b.code(at, {static_cast<uint16_t>(0x3000 | (order[i] & 0xFF)), 0x4041, 0x6039, 0x683A, 0x189B});
    const uint32_t offset = next - (at + 10 + 4);
    const uint32_t sign = offset >> 24 & 1;
    const uint32_t j1 = (~(offset >> 23) ^ sign) & 1, j2 = (~(offset >> 22) ^ sign) & 1;
    b.code(at + 10, {static_cast<uint16_t>(0xF000 | sign << 10 | (offset >> 12 & 0x3FF)),
                     static_cast<uint16_t>(0x9000 | j1 << 13 | j2 << 11 | (offset >> 1 & 0x7FF))});
  }
  b.core.reset();
  for (unsigned n = 0; n < 13; ++n) b.core.set_reg(n, n);
  b.core.set_reg(7, Bench::ram_base + 0x100);
  b.core.set_reg(15, first_block);
}

/// From now on this process may not map memory for execution.
void refuse_executable_memory() {
  const auto argument = static_cast<uint32_t>(offsetof(seccomp_data, args) + 2 * sizeof(uint64_t));
  sock_filter steps[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_mmap, 0, 3),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, argument),
      BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, PROT_EXEC, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EACCES),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  };
  const sock_fprog program = {static_cast<unsigned short>(std::size(steps)), steps};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
      prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0)
    std::exit(77);
}

/// Whether blocks stand in for the translator with this reason, and do what stepping does.
bool blocks_stand_in(const TranslatorLimits& limits, const std::string& reason) {
  Bench stepping, other;
  stepping.core.set_executor(Executor::stepping);
  choose(other.core, Executor::translator, limits);
  for (Bench* b : {&stepping, &other}) {
    prepare_many_blocks(*b);
    b->core.run(20000);
  }
  return other.core.no_translator() == reason && !other.core.translation() &&
         other.core.reg(3) == stepping.core.reg(3) &&
         other.core.cycles() == stepping.core.cycles() &&
         other.core.instructions() == stepping.core.instructions();
}

}  // namespace

TEST(TranslatorHost, AFullBufferIsEmptiedAndChangesNothing) {
  for (const uint8_t threshold : {1, 3}) {
    SCOPED_TRACE(static_cast<unsigned>(threshold));
    Bench stepping, translated;
    stepping.core.set_executor(Executor::stepping);
    choose(translated.core, Executor::translator, smallest_translator());
    translated.core.set_translation_threshold(threshold);
    for (Bench* b : {&stepping, &translated}) prepare_many_blocks(*b);
    for (unsigned slice = 1; slice <= 100; ++slice) {
      for (Bench* b : {&stepping, &translated}) b->core.run(slice * 1501);
      for (unsigned n = 0; n < 16; ++n)
        ASSERT_EQ(stepping.core.reg(n), translated.core.reg(n)) << "r" << n << " slice " << slice;
      ASSERT_EQ(stepping.core.cycles(), translated.core.cycles());
      ASSERT_EQ(stepping.core.instructions(), translated.core.instructions());
    }
    if (!has_translator()) continue;
    const TranslationCounts counts = translated.core.translation().value();
    // After an eviction blocks have to become hot again, all of them.
    EXPECT_GT(counts.evictions, threshold == 1 ? 100u : 3u);
    EXPECT_GT(counts.blocks, threshold == 1 ? 2 * block_count : 100u);
    EXPECT_GT(counts.bytes, counts.evictions * 4096);
    EXPECT_GT(counts.instructions, threshold == 1 ? 10000u : 500u);
    EXPECT_EQ(counts.executed, translated.core.instructions());
    EXPECT_LE(counts.instructions + counts.stepped, counts.executed);
  }
}

/// What the guest can make the host keep does not grow.
TEST(TranslatorHost, TheSameBlocksAreTranslatedOnceWhileThereIsRoom) {
  if (!has_translator()) GTEST_SKIP();
  Bench b;
  choose(b.core, Executor::translator);
  prepare_many_blocks(b);
  b.core.run(100000);
  const TranslationCounts counts = b.core.translation().value();
  EXPECT_EQ(counts.evictions, 0u);
  EXPECT_EQ(counts.blocks, block_count);
  EXPECT_GT(counts.instructions, counts.executed * 9 / 10);
}

TEST(TranslatorHost, WhereMemoryMayNotBeExecutedBlocksStandIn) {
  if (!has_translator()) GTEST_SKIP();
  const auto child = [] {
    refuse_executable_memory();
    std::exit(blocks_stand_in({}, "this system refuses executable memory") ? 0 : 1);
  };
  EXPECT_EXIT(child(), testing::ExitedWithCode(0), "") << "77: no seccomp here";
}

TEST(TranslatorHost, WithoutBmiBlocksStandIn) {
  if (!has_translator()) GTEST_SKIP();
  TranslatorLimits limits;
  limits.bit_manipulation = false;
  EXPECT_TRUE(blocks_stand_in(limits, "this processor has no BMI1 and BMI2"));
}

TEST(TranslatorHost, ItsCodeIsNeverWritableAndExecutableAtOneAddress) {
  if (!has_translator()) GTEST_SKIP();
  Bench b;
  choose(b.core, Executor::translator);
  uintptr_t code = 0;
  b.core.listeners().translated = [&](const Translation& t) {
    code = reinterpret_cast<uintptr_t>(t.code);
  };
  prepare_many_blocks(b);
  b.core.run(1000);
  std::FILE* maps = std::fopen("/proc/self/maps", "r");
  ASSERT_NE(maps, nullptr);
  char line[512], rights[5] = {};
  unsigned found = 0;
  while (std::fgets(line, sizeof line, maps) != nullptr) {
    unsigned long from = 0, to = 0;
    if (std::sscanf(line, "%lx-%lx %4s", &from, &to, rights) != 3) continue;
    EXPECT_FALSE(rights[1] == 'w' && rights[2] == 'x') << line;
    if (code < from || code >= to) continue;
    EXPECT_STREQ(rights, "r-xs");
    ++found;
  }
  std::fclose(maps);
  EXPECT_EQ(found, 1u);
}

TEST(TranslatorHost, EachTranslationIsToldWithAListing) {
  if (!has_translator()) GTEST_SKIP();
  Bench b;
  choose(b.core, Executor::translator);
  std::vector<Translation> all;
  b.core.listeners().translated = [&](const Translation& t) { all.push_back(t); };
  // 0: ldr r0,[r7]; adds r1,r1,r0; cmp r1,#9; bne 0; movs r1,#0; b 0
  b.start({0x6838, 0x1809, 0x2909, 0xD1FB, 0x2100, 0xE7F9});
  b.core.set_reg(7, Bench::ram_base);
  b.core.run(2000);
  ASSERT_FALSE(all.empty());
  const Translation& first = all.front();
  EXPECT_EQ(first.address, Bench::program);
  EXPECT_GT(first.bytes, 40u);
  for (const char* part : {"00001000 ldr r0, [r7]", "00001004 cmp r1, #0x9", "00001006 bne",
                           "mov ebx", "outside the window", "ways out"})
    EXPECT_NE(first.listing.find(part), std::string::npos) << part << " in\n" << first.listing;
  std::size_t bytes = 0;
  for (const Translation& t : all) bytes += t.bytes;
  EXPECT_EQ(b.core.translation()->blocks, all.size());
  EXPECT_EQ(b.core.translation()->bytes, bytes);
}

}  // namespace capsoc::armv7m::test
