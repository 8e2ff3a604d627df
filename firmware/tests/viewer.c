// Text for the printf viewer of a debugger: it enables the ITM, and the program asks whether it has
// (CMSIS's ITM_SendChar). What DEMCR, ITM_TCR and ITM_TER say is printed first; then the processor
// is reset once, and all of it is done again.
#include <stdint.h>

#include "core_cm3.h"
#include "fixed_print.h"

#define ITM_PORT8(n) (*(volatile uint8_t*)(0xE0000000u + 4u * (n)))
#define ITM_PORT16(n) (*(volatile uint16_t*)(0xE0000000u + 4u * (n)))
#define ITM_PORT32(n) (*(volatile uint32_t*)(0xE0000000u + 4u * (n)))
#define ITM_TER (*(volatile uint32_t*)0xE0000E00u)
#define ITM_TCR (*(volatile uint32_t*)0xE0000E80u)

static void send(unsigned port, char c) {
  if ((ITM_TCR & 1) == 0 || (ITM_TER & 1u << port) == 0) return;
  while (ITM_PORT32(port) == 0) {
  }
  ITM_PORT8(port) = (uint8_t)c;
}

static void send_text(unsigned port, const char* text) {
  for (; *text != 0; ++text) send(port, *text);
}

int main(void) {
  volatile uint32_t* const mark = (volatile uint32_t*)0x20300000u;  // a reset keeps memory
  print_text("trcena ");
  print_unsigned(CoreDebug->DEMCR >> 24 & 1, 0);
  print_text(" tcr ");
  print_unsigned(ITM_TCR, 0);
  print_text(" ter ");
  print_unsigned(ITM_TER, 0);
  print_text("\n");
  send_text(0, "by itm\n");
  send_text(3, "port three\n");
  if ((ITM_TCR & 1) != 0) {
    ITM_PORT16(0) = 0x4241;
    ITM_PORT32(0) = 0x0A444343;
  }
  if (*mark == 0x5EE9) return 0;
  *mark = 0x5EE9;
  while ((*(volatile uint32_t*)0x40004004u & 1) != 0) {  // the UART takes the last byte
  }
  for (volatile int i = 0; i < 3000; ++i) {
  }
  SCB->AIRCR = 0x05FA0004u;
  for (;;) {
  }
}
