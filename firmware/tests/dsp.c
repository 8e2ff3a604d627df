// The DSP extension of Armv7-M: every instruction with operands at their borders. Of the results
// and of APSR with Q and GE a hash is printed, the same on every Cortex-M4.
#include <stdio.h>

#include "core_cm3.h"
#include "handlers.h"

static const uint32_t borders[] = {0x00000000, 0x00000001, 0x00008000, 0x7FFF7FFF, 0x80008000,
                                   0x7FFF8000, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x80FF7F01};
enum { count = sizeof borders / sizeof *borders };

static uint32_t hash;
static void add(uint32_t word) {
  for (int i = 0; i < 4; ++i, word >>= 8) hash = (hash ^ (word & 0xFF)) * 16777619u;  // FNV-1a
}

// r0: Rd, or RdLo; r1, r2: operands; r3: Ra, or RdHi. Flags are all clear or all set before.
#define TRY(instruction)                                                    \
  do {                                                                      \
    hash = 2166136261u;                                                     \
    for (unsigned i = 0; i < count * count * 2; ++i) {                      \
      register uint32_t d __asm("r0") = borders[(i + 3) % count];           \
      register uint32_t n __asm("r1") = borders[i % count];                 \
      register uint32_t m __asm("r2") = borders[i / count % count];         \
      register uint32_t a __asm("r3") = borders[(i + i / count) % count];   \
      uint32_t apsr = i < count * count ? 0 : 0xF80F0000u;                  \
      __asm volatile("msr apsr_nzcvqg, %0\n " instruction "\n mrs %0, apsr" \
                     : "+r"(apsr), "+r"(d), "+r"(a)                         \
                     : "r"(n), "r"(m)                                       \
                     : "cc");                                               \
      const uint32_t low = d, high = a;                                     \
      add(low);                                                             \
      add(high);                                                            \
      add(apsr);                                                            \
    }                                                                       \
    printf("%-26s %08lx\n", instruction, (unsigned long)hash);              \
  } while (0)

#define PARALLEL(prefix)          \
  TRY(prefix "add16 r0, r1, r2"); \
  TRY(prefix "asx r0, r1, r2");   \
  TRY(prefix "sax r0, r1, r2");   \
  TRY(prefix "sub16 r0, r1, r2"); \
  TRY(prefix "add8 r0, r1, r2");  \
  TRY(prefix "sub8 r0, r1, r2")

static volatile uint32_t stacked, in_handler;
__attribute__((used)) static void note_call(struct exception_frame* frame, uint32_t exc_return) {
  (void)exc_return;
  uint32_t apsr;
  __asm volatile("uadd8 %0, %1, %1\n mrs %0, apsr" : "=r"(apsr) : "r"(0x80808080u) : "cc");
  in_handler = apsr;
  stacked = frame->xpsr;
}
HANDLER_WITH_FRAME(handle_call, note_call)

static void extensions(void) {
  TRY("sxtab r0, r1, r2");
  TRY("sxtab r0, r1, r2, ror #16");
  TRY("sxtah r0, r1, r2, ror #8");
  TRY("sxtab16 r0, r1, r2, ror #24");
  TRY("sxtb16 r0, r2, ror #8");
  TRY("uxtab r0, r1, r2, ror #8");
  TRY("uxtah r0, r1, r2");
  TRY("uxtab16 r0, r1, r2");
  TRY("uxtb16 r0, r2, ror #16");
  TRY("pkhbt r0, r1, r2, lsl #5");
  TRY("pkhtb r0, r1, r2, asr #7");
  TRY("pkhtb r0, r1, r2, asr #32");
  TRY("sel r0, r1, r2");
}

static void saturation(void) {
  TRY("qadd r0, r1, r2");
  TRY("qsub r0, r1, r2");
  TRY("qdadd r0, r1, r2");
  TRY("qdsub r0, r1, r2");
  TRY("ssat16 r0, #1, r1");
  TRY("ssat16 r0, #11, r1");
  TRY("usat16 r0, #0, r1");
  TRY("usat16 r0, #9, r1");
}

static void multiplications(void) {
  TRY("smulbb r0, r1, r2");
  TRY("smulbt r0, r1, r2");
  TRY("smultb r0, r1, r2");
  TRY("smultt r0, r1, r2");
  TRY("smlabb r0, r1, r2, r3");
  TRY("smlabt r0, r1, r2, r3");
  TRY("smlatb r0, r1, r2, r3");
  TRY("smlatt r0, r1, r2, r3");
  TRY("smulwb r0, r1, r2");
  TRY("smulwt r0, r1, r2");
  TRY("smlawb r0, r1, r2, r3");
  TRY("smlawt r0, r1, r2, r3");
  TRY("smuad r0, r1, r2");
  TRY("smuadx r0, r1, r2");
  TRY("smlad r0, r1, r2, r3");
  TRY("smladx r0, r1, r2, r3");
  TRY("smusd r0, r1, r2");
  TRY("smusdx r0, r1, r2");
  TRY("smlsd r0, r1, r2, r3");
  TRY("smlsdx r0, r1, r2, r3");
  TRY("smmul r0, r1, r2");
  TRY("smmulr r0, r1, r2");
  TRY("smmla r0, r1, r2, r3");
  TRY("smmlar r0, r1, r2, r3");
  TRY("smmls r0, r1, r2, r3");
  TRY("smmlsr r0, r1, r2, r3");
  TRY("usad8 r0, r1, r2");
  TRY("usada8 r0, r1, r2, r3");
  TRY("smlalbb r0, r3, r1, r2");
  TRY("smlalbt r0, r3, r1, r2");
  TRY("smlaltb r0, r3, r1, r2");
  TRY("smlaltt r0, r3, r1, r2");
  TRY("smlald r0, r3, r1, r2");
  TRY("smlaldx r0, r3, r1, r2");
  TRY("smlsld r0, r3, r1, r2");
  TRY("smlsldx r0, r3, r1, r2");
  TRY("umaal r0, r3, r1, r2");
}

int main(void) {
  extensions();
  PARALLEL("s");
  PARALLEL("q");
  PARALLEL("sh");
  PARALLEL("u");
  PARALLEL("uq");
  PARALLEL("uh");
  saturation();
  multiplications();
  TRY("msr apsr_g, r1");
  TRY("msr apsr_nzcvq, r1");
  TRY("it ge\n selge r0, r1, r2");
  take_vectors()[EXCEPTION_SVCALL] = handle_call;
  uint32_t after;
  __asm volatile("msr apsr_nzcvqg, %1\n svc #0\n mrs %0, apsr"
                 : "=r"(after)
                 : "r"(0x280A0000u)
                 : "cc", "memory");
  printf("handler %08lx, stacked %08lx, after %08lx\n", (unsigned long)in_handler,
         (unsigned long)stacked & 0xFF0F0000u, (unsigned long)after);
  return 0;
}
