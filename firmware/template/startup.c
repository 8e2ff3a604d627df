// Reset and the vector table. A handler is taken over by defining a function of its name.
#include <stdint.h>

extern uint32_t stack_top[], data_load[], data_start[], data_end[], bss_start[], bss_end[];

int main(void);
void Reset_Handler(void);
_Noreturn void program_exit(int status);

// A fault that nobody handles locks the core up, which ends a simulation at once with a report.
__attribute__((naked, used)) void unhandled(void) {
  __asm volatile("udf #0");
}

#define WEAK __attribute__((weak, alias("unhandled")))
WEAK void NMI_Handler(void);
WEAK void HardFault_Handler(void);
WEAK void SVC_Handler(void);
WEAK void PendSV_Handler(void);
WEAK void SysTick_Handler(void);
WEAK void UART0_RX_Handler(void);
WEAK void UART0_TX_Handler(void);
WEAK void TIMER0_Handler(void);
WEAK void TIMER1_Handler(void);
WEAK void COPROCESSOR_Handler(void);
WEAK void ADC_Handler(void);

typedef void (*handler)(void);
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
                   [10] = SVC_Handler,
                   [13] = PendSV_Handler,
                   [14] = SysTick_Handler},
    // Index: interrupt line of the board.
    .interrupts = {[0] = UART0_RX_Handler,
                   [1] = UART0_TX_Handler,
                   [8] = TIMER0_Handler,
                   [9] = TIMER1_Handler,
                   [30] = COPROCESSOR_Handler,
                   [31] = ADC_Handler},
};

void Reset_Handler(void) {
  const uint32_t* from = data_load;
  for (uint32_t* to = data_start; to != data_end; ++to) *to = *from++;
  for (uint32_t* to = bss_start; to != bss_end; ++to) *to = 0;
  program_exit(main());
}

// Semihosting SYS_EXIT_EXTENDED: the status becomes the simulator's.
_Noreturn void program_exit(int status) {
  const uint32_t block[2] = {0x20026, (uint32_t)status};
  register uint32_t operation __asm("r0") = 0x20;
  register const uint32_t* argument __asm("r1") = block;
  __asm volatile("bkpt 0xAB" : "+r"(operation) : "r"(argument) : "memory");
  for (;;) __asm volatile("wfi");
}
