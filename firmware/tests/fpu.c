// The floating-point extension of Armv7-M: every instruction with operands at their borders, in
// every rounding mode, flushing to zero and with default NaNs. Of the results and of FPSCR a hash
// is printed, the same on every Cortex-M4 with FPU.
#include <stdint.h>
#include <stdio.h>

static const uint32_t borders[] = {0x00000000, 0x80000000, 0x00000001, 0x807FFFFF, 0x00800000,
                                   0x3F7FFFFF, 0x3F800000, 0xBF800001, 0x40490FDB, 0x33800000,
                                   0xC2FE8000, 0x477FF000, 0x4EFFFFFF, 0xCF000000, 0x7F7FFFFF,
                                   0x7F800000, 0xFF800000, 0x7FC00001, 0xFFA00002, 0x7C01FC00};
enum { count = sizeof borders / sizeof *borders };
// RMode, FZ, DN and AHP of FPSCR.
static const uint32_t modes[] = {0x00000000, 0x00400000, 0x00800000, 0x00C00000, 0x01000000,
                                 0x02000000, 0x03400000, 0x04000000, 0x07C00000};
enum { mode_count = sizeof modes / sizeof *modes };

static uint32_t hash;
static void add(uint32_t word) {
  for (int i = 0; i < 4; ++i, word >>= 8) hash = (hash ^ (word & 0xFF)) * 16777619u;  // FNV-1a
}

// s0: Sd; s1, s2: operands; s3: a neighbour; r0 and r1: core registers.
#define TRY_IN(instruction, some_modes)                                              \
  do {                                                                               \
    hash = 2166136261u;                                                              \
    for (unsigned i = 0; i < count * count * (some_modes); ++i) {                    \
      register uint32_t d __asm("r0") = borders[(i + i / count) % count];            \
      register uint32_t n __asm("r1") = borders[i % count];                          \
      const uint32_t m = borders[i / count % count];                                 \
      uint32_t fpscr = modes[i / (count * count)];                                   \
      uint32_t single, neighbour;                                                    \
      __asm volatile(                                                                \
          "vmsr fpscr, %2\n vmov s0, %0\n vmov s1, %1\n vmov s2, %5\n vmov s3, %0\n" \
          " " instruction "\n vmov %3, s0\n vmov %4, s3\n vmrs %2, fpscr"            \
          : "+r"(d), "+r"(n), "+&r"(fpscr), "=&r"(single), "=&r"(neighbour)          \
          : "r"(m)                                                                   \
          : "s0", "s1", "s2", "s3", "cc", "memory");                                 \
      const uint32_t low = d, high = n;                                              \
      add(low);                                                                      \
      add(high);                                                                     \
      add(single);                                                                   \
      add(neighbour);                                                                \
      add(fpscr);                                                                    \
    }                                                                                \
    printf("%-40s %08lx\n", instruction, (unsigned long)hash);                       \
  } while (0)
#define TRY(instruction) TRY_IN(instruction, mode_count)

static void arithmetic(void) {
  TRY("vadd.f32 s0, s1, s2");
  TRY("vsub.f32 s0, s1, s2");
  TRY("vmul.f32 s0, s1, s2");
  TRY("vnmul.f32 s0, s1, s2");
  TRY("vmla.f32 s0, s1, s2");
  TRY("vmls.f32 s0, s1, s2");
  TRY("vnmla.f32 s0, s1, s2");
  TRY("vnmls.f32 s0, s1, s2");
  TRY("vfma.f32 s0, s1, s2");
  TRY("vfms.f32 s0, s1, s2");
  TRY("vfnma.f32 s0, s1, s2");
  TRY("vfnms.f32 s0, s1, s2");
  TRY("vdiv.f32 s0, s1, s2");
  TRY("vsqrt.f32 s0, s1");
  TRY("vabs.f32 s0, s1");
  TRY("vneg.f32 s0, s1");
  TRY("vcmp.f32 s1, s2");
  TRY("vcmpe.f32 s1, s2");
  TRY("vcmp.f32 s1, #0.0");
  TRY("vcmpe.f32 s1, #0.0");
}

static void conversions(void) {
  TRY("vcvt.s32.f32 s0, s1");
  TRY("vcvt.u32.f32 s0, s1");
  TRY("vcvtr.s32.f32 s0, s1");
  TRY("vcvtr.u32.f32 s0, s1");
  TRY("vcvt.f32.s32 s0, s1");
  TRY("vcvt.f32.u32 s0, s1");
  TRY("vcvt.s32.f32 s0, s0, #7");
  TRY("vcvt.u32.f32 s0, s0, #31");
  TRY("vcvt.s16.f32 s0, s0, #3");
  TRY("vcvt.u16.f32 s0, s0, #16");
  // To nearest whatever RMode is (A7.7): here it is.
  TRY_IN("vcvt.f32.s32 s0, s0, #9", 1);
  TRY_IN("vcvt.f32.u32 s0, s0, #32", 1);
  TRY_IN("vcvt.f32.s16 s0, s0, #5", 1);
  TRY_IN("vcvt.f32.u16 s0, s0, #1", 1);
  TRY("vcvtb.f32.f16 s0, s1");
  TRY("vcvtt.f32.f16 s0, s1");
  TRY("vcvtb.f16.f32 s0, s1");
  TRY("vcvtt.f16.f32 s0, s1");
}

static void moves(void) {
  TRY("vmov.f32 s0, s1");
  TRY("vmov.f32 s0, #-1.9375");
  TRY("vmov r0, s2");
  TRY("vmov s0, r1");
  TRY("vmov r1, r0, s1, s2");
  TRY("vmov s2, s3, r1, r0");
  TRY("vmov r0, r1, d1");
  TRY("vmov d0, r1, r0");
  // The assembler takes these two for a larger FPU's.
  TRY(".inst.w 0xee211b10 @ vmov.32 d1[1], r1");
  TRY(".inst.w 0xee300b10 @ vmov.32 r0, d0[1]");
  TRY("vcmp.f32 s1, s2\n vmrs apsr_nzcv, fpscr\n ite gt\n vmovgt s0, s1\n vmovle s0, s2");
  TRY("vcmp.f32 s1, s2\n vmrs apsr_nzcv, fpscr\n itt vs\n vaddvs.f32 s0, s1, s2\n movvs r0, #1");
}

static void transfers(void) {
  TRY("vpush {s0-s2}\n vldr s3, [sp, #4]\n vpop {s1-s3}");
  TRY("vpush {d0, d1}\n vstr d1, [sp]\n vldmia sp!, {s2}\n vpop {s0, s1, s2}");
  TRY("sub sp, #16\n vstmia sp, {s1, s2}\n vldr d0, [sp]\n add sp, #16");
  TRY("push {r0, r1}\n mov r1, sp\n vldmia r1!, {d0}\n vstmdb r1!, {s1, s2}\n pop {r0, r1}");
}

int main(void) {
  arithmetic();
  conversions();
  moves();
  transfers();
  return 0;
}
