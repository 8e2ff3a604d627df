// Sends bytes in every way in which a program may: with and without asking for room, as words and
// as bytes, with interrupts switched on and off in between. It reads the status at all kinds of
// distances. What it prints depends on the cycle at which each of this happened.
#include "an385.h"
#include "fixed_print.h"
#include "uart.h"

enum { transmit_overrun = 1u << 2, all_interrupts = CMSDK_UART_CTRL_TXIRQEN_Msk | 1u << 4 };

static volatile uint32_t interrupts, interrupts_at;
static uint32_t seen, random_state = 3;

void UART1_TX_Handler(void) {
  UART1->INTSTATUS = CMSDK_UART_INT_TX_Msk;
  ++interrupts;
  interrupts_at = interrupts_at * 31 + DWT->CYCCNT;
}

static uint32_t choose(uint32_t count) {
  random_state = random_state * 1664525 + 1013904223;
  return (random_state >> 16) % count;
}

static void note(uint32_t value) {
  seen = seen * 31 + value;
}

static void wait_for_room(void) {
  while ((UART1->STATE & CMSDK_UART_STATE_TXFULL_Msk) != 0) {
  }
}

static void act(uint32_t value) {
  switch (choose(8)) {
    case 0:
    case 1:
      wait_for_room();
      UART1->DATA = value;
      break;
    case 2:
      wait_for_room();
      *(volatile uint8_t*)&UART1->DATA = (uint8_t)value;
      break;
    case 3:
      UART1->DATA = value;  // where there is no room, the byte before it is lost
      break;
    case 4:
      UART1->CTRL = CMSDK_UART_CTRL_TXEN_Msk | (choose(2) != 0 ? all_interrupts : 0);
      break;
    case 5:
      for (uint32_t n = choose(300); n != 0; --n) __asm volatile("");
      note(UART1->STATE);
      break;
    case 6:
      for (uint32_t n = choose(200); n != 0; --n) note(UART1->STATE);
      break;
    default:
      UART1->STATE = transmit_overrun;
      uart_write(UART1, "ab", 2);
      break;
  }
}

int main(void) {
  static const uint16_t dividers[] = {16, 53, 217};
  CoreDebug->DEMCR |= CoreDebug_DEMCR_TRCENA_Msk;
  DWT->CTRL |= DWT_CTRL_CYCCNTENA_Msk;
  NVIC_EnableIRQ(UART1_TX_IRQn);
  for (uint32_t rate = 0; rate < 3; ++rate) {
    UART1->BAUDDIV = dividers[rate];
    UART1->CTRL = CMSDK_UART_CTRL_TXEN_Msk;
    for (uint32_t n = 0; n < 300; ++n) {
      act(n & 0xFF);
      note(DWT->CYCCNT);
    }
  }
  print_text("transmit: ");
  print_unsigned(interrupts, 0);
  print_text(" ");
  print_unsigned(interrupts_at, 0);
  print_text(" ");
  print_unsigned(seen, 0);
  print_text("\n");
  return 0;
}
