#include "protection.h"

#include "an385.h"
#include "semihosting.h"

// Symbols of linker.ld.
extern uint32_t stack_guard[];

typedef struct {
  __IO uint32_t LOAD;
  __I uint32_t VALUE;
  __IO uint32_t CONTROL;
  __O uint32_t INTCLR;
  uint32_t others[764];
  __IO uint32_t LOCK;
} CMSDK_WATCHDOG_Type;
#define WATCHDOG ((CMSDK_WATCHDOG_Type*)0x40008000u)
enum { watchdog_interrupts = 1, watchdog_resets = 2 };
static const uint32_t unlocked = 0x1ACCE551;

typedef struct {
  __I uint32_t TYPE;
  __IO uint32_t CTRL;
  __IO uint32_t RNR;
  __IO uint32_t RBAR;
  __IO uint32_t RASR;
} mpu_unit;
#define MPU ((mpu_unit*)0xE000ED90u)
// B3.5.5, B3.5.9. With the default map for what no region covers.
enum { mpu_enable = 1, mpu_default_map = 4, region_enable = 1 };
#define NO_ACCESS 0u
#define FULL_ACCESS (3u << 24)
#define READ_ONLY (6u << 24)
#define EXECUTE_NEVER (1u << 28)
enum { memory_fault_enable = 1 << 16 };

// Polled: the transmit interrupt may never come again.
static void write_polled(const char* text) {
  UART0->CTRL = CMSDK_UART_CTRL_TXEN_Msk;
  for (; *text != '\0'; ++text) {
    while ((UART0->STATE & CMSDK_UART_STATE_TXFULL_Msk) != 0) {
    }
    UART0->DATA = (uint8_t)*text;
  }
  while ((UART0->STATE & CMSDK_UART_STATE_TXFULL_Msk) != 0) {
  }
}

// Calls nothing outside this file but the exit: what it would call may be what is broken.
void safe_stop(int status, const char* why) {
  __disable_irq();
  GPIO0->MASKLOWBYTE[angle_good_pin] = 0;
  WATCHDOG->LOCK = unlocked;
  WATCHDOG->CONTROL = 0;
  write_polled("\nsafe: stopped by the ");
  write_polled(why);
  write_polled("\n");
  semihosting_exit(status);
}

// The stack may be what is broken: the handlers begin a new one.
#define ON_A_NEW_STACK(handler, stop)                              \
  __attribute__((naked)) void handler(void) {                      \
    __asm volatile("ldr r0, =stack_top\n msr msp, r0\n b " #stop); \
  }

__attribute__((used)) static void stop_by_watchdog(void) {
  safe_stop(stopped_by_watchdog, "watchdog");
}
ON_A_NEW_STACK(NMI_Handler, stop_by_watchdog)

__attribute__((used)) static void stop_by_protection(void) {
  safe_stop(stopped_by_fault, "memory protection");
}
ON_A_NEW_STACK(MemManage_Handler, stop_by_protection)

__attribute__((used)) static void stop_by_fault(void) {
  safe_stop(stopped_by_fault, "processor's fault");
}
ON_A_NEW_STACK(HardFault_Handler, stop_by_fault)

static void region(uint32_t number, const void* base, uint32_t bytes, uint32_t rights) {
  uint32_t size = 4;  // 2^(size + 1) bytes
  while (size < 31 && (UINT32_C(2) << size) < bytes) ++size;
  MPU->RNR = number;
  MPU->RBAR = (uint32_t)(uintptr_t)base;
  MPU->RASR = rights | size << 1 | region_enable;
}

void protect_memory(const void* block, uint32_t bytes) {
  const void* const code = (const void*)0;
  const void* const data = (const void*)0x20000000u;
  region(0, code, 0x400000, READ_ONLY);
  region(1, data, 0x400000, FULL_ACCESS | EXECUTE_NEVER);
  region(2, stack_guard, 32, NO_ACCESS | EXECUTE_NEVER);
  region(3, block, bytes, READ_ONLY | EXECUTE_NEVER);
  SCB->SHCSR |= memory_fault_enable;
  MPU->CTRL = mpu_enable | mpu_default_map;
  __DSB();
  __ISB();
}

void watchdog_start(uint32_t cycles) {
  WATCHDOG->LOCK = unlocked;
  WATCHDOG->LOAD = cycles;
  WATCHDOG->CONTROL = watchdog_interrupts | watchdog_resets;
  WATCHDOG->LOCK = 0;
}

void watchdog_serve(void) {
  WATCHDOG->LOCK = unlocked;
  WATCHDOG->INTCLR = 1;
  WATCHDOG->LOCK = 0;
}
