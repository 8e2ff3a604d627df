// Vector table and start for the programs of scripts/tool foreign_firmware: newlib over semihosting
// (librdimon), code in SSRAM 1, everything else in the PSRAM. PROGRAM_ARGUMENTS: the strings of
// argv.
#include <stdint.h>
#include <stdlib.h>

extern uint32_t bss_begin[], bss_end[], stack_top[];
extern void initialise_monitor_handles(void);
extern void __libc_init_array(void);
int main(int argc, char** argv, char** environment);

static char* arguments[] = {PROGRAM_ARGUMENTS, 0};
static char* environment[] = {0};

void _init(void) {}
void _fini(void) {}

// What a program that writes code calls before it jumps there.
void __clear_cache(void* begin, void* end) {
  (void)begin;
  (void)end;
  __asm volatile("dsb\n\tisb" ::: "memory");
}

static void semihosting(uint32_t operation, const void* parameter) {
  register uint32_t r0 __asm("r0") = operation;
  register const void* r1 __asm("r1") = parameter;
  __asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

static void fault(void) {
  semihosting(0x04, "FAULT\n");              // SYS_WRITE0
  semihosting(0x18, (const void*)0x20023u);  // SYS_EXIT, run-time error
  for (;;) {
  }
}

// A test may bring its own memset, so none is called here.
void reset(void) {
  for (volatile uint32_t* word = bss_begin; word < bss_end; ++word) *word = 0;
  initialise_monitor_handles();
  __libc_init_array();
  exit(main((int)(sizeof arguments / sizeof arguments[0]) - 1, arguments, environment));
}

__attribute__((section(".vectors"), used)) void* const vectors[16] = {
    stack_top, reset, fault, fault, fault, fault, fault, 0, 0, 0, 0, fault, fault, 0, fault, fault};
