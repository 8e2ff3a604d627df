// Reset, the vector table and the default handlers.
#include <stdint.h>
#include <stdlib.h>

#include "system.h"

typedef void (*handler)(void);

// Symbols of linker.ld.
extern uint32_t stack_top[], data_load[], data_start[], data_end[], bss_start[], bss_end[];

// newlib: runs the constructors.
void __libc_init_array(void);

// What newlib calls around constructors and destructors; nothing to do here.
void _init(void);
void _fini(void);
void _init(void) {}
void _fini(void) {}

int main(void);
void Reset_Handler(void);

// A fault without a handler locks the core up: an undefined instruction inside HardFault cannot be
// escalated further. That stops a simulator and a debugger at once, where an endless loop would
// only run into a time limit. No instruction before it touches the stacked frame or a register, so
// the first fault can be read from them. In other handlers the instruction escalates to HardFault.
__attribute__((naked, used)) void fault_lockup(void) {
  __asm volatile("udf #0");
}

#define WEAK __attribute__((weak, alias("fault_lockup")))
WEAK void NMI_Handler(void);
WEAK void HardFault_Handler(void);
WEAK void MemManage_Handler(void);
WEAK void BusFault_Handler(void);
WEAK void UsageFault_Handler(void);
WEAK void SVC_Handler(void);
WEAK void DebugMon_Handler(void);
WEAK void PendSV_Handler(void);
WEAK void SysTick_Handler(void);
WEAK void UART0_RX_Handler(void);
WEAK void UART0_TX_Handler(void);
WEAK void UART1_RX_Handler(void);
WEAK void UART1_TX_Handler(void);
WEAK void UART2_RX_Handler(void);
WEAK void UART2_TX_Handler(void);
WEAK void GPIO0_Handler(void);
WEAK void GPIO1_Handler(void);
WEAK void TIMER0_Handler(void);
WEAK void TIMER1_Handler(void);
WEAK void DUALTIMER_Handler(void);
WEAK void SPI_Handler(void);
WEAK void UART_OVERFLOW_Handler(void);
WEAK void ETHERNET_Handler(void);
WEAK void I2S_Handler(void);
WEAK void TOUCHSCREEN_Handler(void);
WEAK void GPIO2_Handler(void);
WEAK void GPIO3_Handler(void);
WEAK void UART3_RX_Handler(void);
WEAK void UART3_TX_Handler(void);
WEAK void UART4_RX_Handler(void);
WEAK void UART4_TX_Handler(void);
WEAK void SPI1_Handler(void);
WEAK void SPI2_Handler(void);
WEAK void COPROCESSOR_Handler(void);
WEAK void ADC_Handler(void);
// Lines without a device: for one that is added (docs/developer/extending.md).
WEAK void IRQ23_Handler(void);
WEAK void IRQ25_Handler(void);
WEAK void IRQ26_Handler(void);
WEAK void IRQ27_Handler(void);
WEAK void IRQ28_Handler(void);
WEAK void IRQ29_Handler(void);

struct vector_table {
  const void* initial_stack;
  handler exceptions[15];
  handler interrupts[32];
};

__attribute__((section(".vectors"), used)) const struct vector_table vector_table = {
    .initial_stack = stack_top,
    // Index: exception number - 1.
    .exceptions = {[0] = Reset_Handler,
                   [1] = NMI_Handler,
                   [2] = HardFault_Handler,
                   [3] = MemManage_Handler,
                   [4] = BusFault_Handler,
                   [5] = UsageFault_Handler,
                   [10] = SVC_Handler,
                   [11] = DebugMon_Handler,
                   [13] = PendSV_Handler,
                   [14] = SysTick_Handler},
    .interrupts = {UART0_RX_Handler,      UART0_TX_Handler,  UART1_RX_Handler,
                   UART1_TX_Handler,      UART2_RX_Handler,  UART2_TX_Handler,
                   GPIO0_Handler,         GPIO1_Handler,     TIMER0_Handler,
                   TIMER1_Handler,        DUALTIMER_Handler, SPI_Handler,
                   UART_OVERFLOW_Handler, ETHERNET_Handler,  I2S_Handler,
                   TOUCHSCREEN_Handler,   GPIO2_Handler,     GPIO3_Handler,
                   UART3_RX_Handler,      UART3_TX_Handler,  UART4_RX_Handler,
                   UART4_TX_Handler,      SPI1_Handler,      IRQ23_Handler,
                   SPI2_Handler,          IRQ25_Handler,     IRQ26_Handler,
                   IRQ27_Handler,         IRQ28_Handler,     IRQ29_Handler,
                   COPROCESSOR_Handler,   ADC_Handler},
};

void Reset_Handler(void) {
#ifdef __ARM_FP
  *(volatile uint32_t*)0xE000ED88u = 0xF00000u;  // CPACR: CP10 and CP11
  __asm volatile("dsb\n isb");
#endif
  const uint32_t* from = data_load;
  for (uint32_t* to = data_start; to != data_end; ++to) *to = *from++;
  for (uint32_t* to = bss_start; to != bss_end; ++to) *to = 0;
  system_init();
  __libc_init_array();
  exit(main());
}
