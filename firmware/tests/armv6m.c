// Armv6-M for itself: what faults and what the handler finds, system registers, priorities, both
// stacks, and division by libgcc. Output and end are by semihosting, and nothing else of the board
// is touched, so that the same ELF runs on QEMU's micro:bit.
#include <stdbool.h>
#include <stdint.h>

extern uint32_t stack_top[];
void start(void);

static volatile uint32_t* const icsr = (volatile uint32_t*)0xE000ED04u;
static volatile uint32_t* const iser = (volatile uint32_t*)0xE000E100u;
static volatile uint32_t* const ispr = (volatile uint32_t*)0xE000E200u;
static volatile uint32_t* const ipr = (volatile uint32_t*)0xE000E400u;
static volatile uint32_t* const shpr2 = (volatile uint32_t*)0xE000ED1Cu;
static volatile uint32_t* const shpr3 = (volatile uint32_t*)0xE000ED20u;

enum { sys_open = 0x01, sys_write = 0x05, sys_exit = 0x18, application_exit = 0x20026 };

static uint32_t semihosting(uint32_t operation, const void* argument) {
  register uint32_t number __asm("r0") = operation;
  register const void* block __asm("r1") = argument;
  __asm volatile("bkpt 0xAB" : "+r"(number) : "r"(block) : "memory");
  return number;
}

static uint32_t standard_output;
static void open_standard_output(void) {
  static const char console[] = ":tt";
  enum { for_writing = 4 };
  const uint32_t block[] = {(uint32_t)console, for_writing, sizeof console - 1};
  standard_output = semihosting(sys_open, block);
}

static void print(const char* text) {
  uint32_t length = 0;
  while (text[length] != 0) ++length;
  const uint32_t block[] = {standard_output, (uint32_t)text, length};
  semihosting(sys_write, block);
}

static void print_number(const char* name, uint32_t value) {
  char text[] = " 00000000";
  for (int i = 8; i > 0; --i, value >>= 4) text[i] = "0123456789abcdef"[value & 15];
  print(name);
  print(text);
  print("\n");
}

// What the handlers were entered for, one letter each.
static char order[32];
static unsigned entered;
static void note(char letter) {
  if (entered + 1 < sizeof order) order[entered++] = letter;
}
static void print_order(const char* name) {
  order[entered] = 0;
  print(name);
  print(" ");
  print(order);
  print("\n");
  entered = 0;
}

// Faults: the handler notes where and continues past the instruction.
uint32_t resume_at, faulted_at, faulted_psr, faults;

__attribute__((used)) void fault(uint32_t* frame) {
  ++faults;
  faulted_at = frame[6];
  faulted_psr = frame[7];
  frame[6] = resume_at;
  frame[7] |= 1u << 24;
}

__attribute__((naked)) static void hard_fault(void) {
  __asm volatile(
      "  mov r1, lr\n"
      "  movs r0, #4\n"
      "  tst r0, r1\n"
      "  bne 1f\n"
      "  mrs r0, msp\n"
      "  b 2f\n"
      "1:mrs r0, psp\n"
      "2:ldr r1, =fault\n"
      "  bx r1\n"
      "  .ltorg\n");
}

// A trial: r2 is an odd address in the RAM, r3 one where nothing is. 1: the instruction, 2: past.
#define TRIAL(name, code)                                          \
  static void try_##name(void) {                                   \
    __asm volatile(                                                \
        "ldr r1, =2f\n"                                            \
        "ldr r0, =resume_at\n"                                     \
        "str r1, [r0]\n"                                           \
        "ldr r2, =0x20000101\n"                                    \
        "ldr r3, =0x90000000\n"                                    \
        "1:\n" code "\n2:\n" ::                                    \
            : "r0", "r1", "r2", "r3", "r4", "r5", "memory", "cc"); \
  }
TRIAL(ldr, "ldr r0, [r2]")
TRIAL(ldrh, "ldrh r0, [r2]")
TRIAL(ldrsh, "movs r1, #0\n ldrsh r0, [r2, r1]")
TRIAL(str, "str r0, [r2]")
TRIAL(strh, "strh r0, [r2]")
TRIAL(ldm, "ldm r2!, {r4, r5}")
TRIAL(stm, "stm r2!, {r4, r5}")
TRIAL(ldrb, "ldrb r0, [r2]")
TRIAL(load_nowhere, "ldr r0, [r3]")
TRIAL(store_nowhere, "str r0, [r3]")
TRIAL(udf, "udf #1")
TRIAL(udf_w, ".short 0xF7F0, 0xA000")
TRIAL(udiv, ".short 0xFBB1, 0xF0F2")
TRIAL(movw, ".short 0xF240, 0x0001")
TRIAL(ldr_w, ".short 0xF8D2, 0x0003")
TRIAL(b_w, ".short 0xF000, 0xB800")
TRIAL(tbb, ".short 0xE8D1, 0xF001")
TRIAL(ldrex, ".short 0xE852, 0x0F00")
TRIAL(clrex, ".short 0xF3BF, 0x8F2F")
TRIAL(nop_w, ".short 0xF3AF, 0x8000")
TRIAL(coprocessor, ".short 0xEE00, 0x0A10")
TRIAL(svc_masked, "cpsid i\n svc #0")
TRIAL(even_target, "ldr r0, =2f\n bx r0")
TRIAL(dsb, "dsb\n dmb\n isb")

static void run_trial(const char* name, void (*trial)(void)) {
  faults = faulted_at = faulted_psr = 0;
  trial();
  __asm volatile("cpsie i" ::: "memory");
  print_number(name, faults);
  if (faults == 0) return;
  print_number("  at", faulted_at);
  print_number("  psr", faulted_psr & 0x0100003F);
}

static void try_faults(void) {
#define RUN(name) run_trial(#name, try_##name)
  RUN(ldr);
  RUN(ldrh);
  RUN(ldrsh);
  RUN(str);
  RUN(strh);
  RUN(ldm);
  RUN(stm);
  RUN(ldrb);
  RUN(load_nowhere);
  RUN(store_nowhere);
  RUN(udf);
  RUN(udf_w);
  RUN(udiv);
  RUN(movw);
  RUN(ldr_w);
  RUN(b_w);
  RUN(tbb);
  RUN(ldrex);
  RUN(clrex);
  RUN(nop_w);
  RUN(coprocessor);
  RUN(svc_masked);
  RUN(even_target);
  RUN(dsb);
}

// System registers: what is there, and what keeps all ones.
static void show_registers(void) {
  static const struct {
    const char* name;
    uint32_t address;
  } registers[] = {{"CCR", 0xE000ED14},     {"SHPR1", 0xE000ED18}, {"SHPR2", 0xE000ED1C},
                   {"CFSR", 0xE000ED28},    {"HFSR", 0xE000ED2C},  {"MMFAR", 0xE000ED34},
                   {"BFAR", 0xE000ED38},    {"IPR1", 0xE000E404},  {"MPU_TYPE", 0xE000ED90},
                   {"SYST_RVR", 0xE000E014}};
  for (unsigned i = 0; i < sizeof registers / sizeof registers[0]; ++i) {
    volatile uint32_t* const each = (volatile uint32_t*)registers[i].address;
    const uint32_t before = *each;
    *each = 0xFFFFFFFF;
    const uint32_t after = *each;
    *each = before;
    print_number(registers[i].name, before);
    print_number("  ones", after);
  }
  volatile uint32_t* const aircr = (volatile uint32_t*)0xE000ED0Cu;
  *aircr = 0x05FA0700;
  print_number("PRIGROUP", *aircr & 0x700);
}

static void show_special_registers(void) {
  uint32_t value;
  // BASEPRI, FAULTMASK: the compiler knows neither.
  __asm volatile(
      "movs r0, #1\n .short 0xF380, 0x8813\n mov %0, r0\n .short 0xF3EF, 0x8013\n mov %0, r0"
      : "=r"(value)::"r0");
  print_number("FAULTMASK", value);
  __asm volatile("movs r0, #0x80\n .short 0xF380, 0x8811\n .short 0xF3EF, 0x8011\n mov %0, r0"
                 : "=r"(value)::"r0");
  print_number("BASEPRI", value);
  __asm volatile("ldr r0, =0xF0000000\n msr apsr_nzcvq, r0\n mrs %0, apsr"
                 : "=r"(value)::"r0", "cc");
  print_number("APSR", value);
  __asm volatile("cpsid i\n mrs %0, primask\n cpsie i" : "=r"(value)::"memory");
  print_number("PRIMASK", value);
}

// Priorities.
static void svc(void) {
  note('s');
}
static void pend_sv(void) {
  note('p');
}
static void sys_tick(void) {
  note('t');
}
static void line_0(void) {
  note('0');
  *ispr = 0xE;  // 1: the same level, 2: a higher one, 3: a lower one
  __asm volatile("dsb\n isb" ::: "memory");
  note('.');
}
static void line_1(void) {
  note('1');
}
static volatile bool does_not_call;
static void line_2(void) {
  note('2');
  *icsr = 1u << 28;
  if (!does_not_call) __asm volatile("svc #0" ::: "memory");
  note(',');
}
static void line_3(void) {
  note('3');
}

static void try_priorities(void) {
  *shpr2 = 0;
  *shpr3 = 0x00C00000;
  *ipr = 0xC0408080;  // 0 and 1: 0x80, 2: 0x40, 3: 0xC0
  *iser = 0xF;
  *ispr = 1;
  __asm volatile("dsb\n isb" ::: "memory");
  print_order("levels");
  does_not_call = true;  // at SVCall's own level
  *ipr = 0x20202020;     // no bit of it is there: all alike
  *ispr = 1;
  __asm volatile("dsb\n isb" ::: "memory");
  print_order("one level");
  *icsr = 1u << 26 | 1u << 28;
  __asm volatile("dsb\n isb" ::: "memory");
  print_order("pended");
  __asm volatile("cpsid i" ::: "memory");
  *icsr = 1u << 28;
  __asm volatile("dsb\n isb" ::: "memory");
  note('-');
  print_number("VECTPENDING", *icsr >> 12 & 0x3F);
  __asm volatile("cpsie i\n isb" ::: "memory");
  print_order("masked");
}

// Both stacks; frames lie at multiples of eight.
uint32_t frame_at, frame_psr;
__attribute__((used)) void look(uint32_t* frame) {
  frame_at = (uint32_t)frame;
  frame_psr = frame[7];
}
__attribute__((naked)) static void nmi(void) {
  __asm volatile(
      "  mov r1, lr\n"
      "  movs r0, #4\n"
      "  tst r0, r1\n"
      "  bne 1f\n"
      "  mrs r0, msp\n"
      "  b 2f\n"
      "1:mrs r0, psp\n"
      "2:ldr r1, =look\n"
      "  bx r1\n"
      "  .ltorg\n");
}

static uint64_t process_stack[32];

static void try_stacks(void) {
  const uint32_t end = (uint32_t)(process_stack + 32);
  for (uint32_t odd = 0; odd < 8; odd += 4) {
    __asm volatile(
        "msr psp, %0\n"
        "movs r0, #2\n"
        "msr control, r0\n"
        "isb\n"
        "ldr r0, =0x80000000\n"
        "ldr r1, =0xE000ED04\n"
        "str r0, [r1]\n"
        "dsb\n"
        "isb\n"
        "movs r0, #0\n"
        "msr control, r0\n"
        "isb\n" ::"r"(end - odd)
        : "r0", "r1", "memory", "cc");
    print_number("frame", end - frame_at);
    print_number("  aligned", frame_psr >> 9 & 1);
  }
}

static void try_division(void) {
  volatile uint32_t n = 4000000007u, d = 97;
  volatile int32_t sn = -1000003, sd = 1009;
  volatile uint64_t wide = 0x123456789ABCDEFull, by = 1000000007u;
  volatile float a = 355.0f, b = 113.0f;
  print_number("unsigned", n / d);
  print_number("  rest", n % d);
  print_number("signed", (uint32_t)(sn / sd));
  print_number("  rest", (uint32_t)(sn % sd));
  print_number("64 bits", (uint32_t)(wide / by));
  print_number("  rest", (uint32_t)(wide % by));
  print_number("float", (uint32_t)(a / b * 1000000.0f));
}

__attribute__((noreturn)) void start(void) {
  open_standard_output();
  try_faults();
  show_registers();
  show_special_registers();
  try_priorities();
  try_stacks();
  try_division();
  semihosting(sys_exit, (const void*)application_exit);
  while (true) {
  }
}

typedef void (*handler)(void);
__attribute__((section(".vectors"), used)) static const struct {
  const void* initial_stack;
  handler exceptions[15];
  handler interrupts[32];
} vectors = {
    .initial_stack = stack_top,
    .exceptions =
        {[0] = start, [1] = nmi, [2] = hard_fault, [10] = svc, [13] = pend_sv, [14] = sys_tick},
    .interrupts = {line_0, line_1, line_2, line_3}};
