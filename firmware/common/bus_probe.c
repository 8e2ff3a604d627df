#include "bus_probe.h"

#include "an385.h"

// The load has a name, so that the fault handler can tell its fault from all others and resume at
// the fix-up.
bool bus_probe_load(uint32_t address, uint32_t* value);
__asm(
    ".section .text.bus_probe_load, \"ax\", %progbits\n"
    ".syntax unified\n"
    ".thumb\n"
    ".global bus_probe_load\n"
    ".type bus_probe_load, %function\n"
    ".thumb_func\n"
    "bus_probe_load:\n"
    "bus_probe_load_instruction:\n"
    "  ldr r2, [r0]\n"
    "  str r2, [r1]\n"
    "  movs r0, #1\n"
    "  bx lr\n"
    "bus_probe_fixup:\n"
    "  movs r0, #0\n"
    "  bx lr\n"
    ".size bus_probe_load, . - bus_probe_load\n"
    ".text\n");

// The stacked return address is the seventh word of the frame.
#ifdef __ARM_ARCH_6M__
// Every fault is a HardFault.
__attribute__((naked)) void HardFault_Handler(void) {
  __asm volatile(
      ".syntax unified\n"
      "  mov r1, lr\n"
      "  movs r0, #4\n"
      "  tst r0, r1\n"
      "  bne 1f\n"
      "  mrs r0, msp\n"
      "  b 2f\n"
      "1:mrs r0, psp\n"
      "2:ldr r1, [r0, #24]\n"
      "  ldr r2, =bus_probe_load_instruction\n"
      "  cmp r1, r2\n"
      "  bne 3f\n"
      "  ldr r2, =bus_probe_fixup\n"
      "  str r2, [r0, #24]\n"
      "  bx lr\n"
      "3:udf #0\n"
      "  .ltorg\n");
}

bool bus_probe(uint32_t address, uint32_t* value) {
  return bus_probe_load(address, value);
}
#else
__attribute__((naked)) void BusFault_Handler(void) {
  __asm volatile(
      "  tst lr, #4\n"
      "  ite eq\n"
      "  mrseq r0, msp\n"
      "  mrsne r0, psp\n"
      "  ldr r1, [r0, #24]\n"
      "  ldr r2, =bus_probe_load_instruction\n"
      "  cmp r1, r2\n"
      "  bne 1f\n"
      "  ldr r2, =bus_probe_fixup\n"
      "  str r2, [r0, #24]\n"
      "  bx lr\n"
      "1:udf #0\n"
      "  .ltorg\n");
}

bool bus_probe(uint32_t address, uint32_t* value) {
  // BusFault is enabled for this load only: elsewhere a bus error stays a HardFault.
  SCB->SHCSR |= SCB_SHCSR_BUSFAULTENA_Msk;
  __DSB();
  const bool answered = bus_probe_load(address, value);
  SCB->SHCSR &= ~SCB_SHCSR_BUSFAULTENA_Msk;
  if (!answered) SCB->CFSR = SCB_CFSR_BUSFAULTSR_Msk;  // write 1 to clear
  __DSB();
  return answered;
}
#endif
