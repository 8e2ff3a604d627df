// CMSDK peripherals of the MPS2 AN385 memory map (Cortex-M System Design Kit Technical Reference
// Manual, chapter 4: APB components; Application Note AN385, tables 3-1 and 3-3).
#ifndef CAPSOC_AN385_H
#define CAPSOC_AN385_H

#include <stdint.h>

#include "core_cm3.h"

enum {
  UART0_RX_IRQn = 0,
  UART0_TX_IRQn = 1,
  UART1_RX_IRQn = 2,
  UART1_TX_IRQn = 3,
  UART2_RX_IRQn = 4,
  UART2_TX_IRQn = 5,
  GPIO0_IRQn = 6,
  GPIO1_IRQn = 7,
  TIMER0_IRQn = 8,
  TIMER1_IRQn = 9,
  DUALTIMER_IRQn = 10,
  UART_OVERFLOW_IRQn = 12,
  GPIO2_IRQn = 16,
  GPIO3_IRQn = 17,
};

// What the board runs at when no clock controller says otherwise.
#define AN385_CLOCK_HZ 25000000u

typedef struct {
  __IO uint32_t DATA;
  __IO uint32_t STATE;
  __IO uint32_t CTRL;
  __IO uint32_t INTSTATUS;  // write 1 to clear
  __IO uint32_t BAUDDIV;    // clock cycles a bit, 16 at least
} CMSDK_UART_Type;

#define CMSDK_UART_STATE_TXFULL_Msk (1u << 0)
#define CMSDK_UART_STATE_RXFULL_Msk (1u << 1)
#define CMSDK_UART_CTRL_TXEN_Msk (1u << 0)
#define CMSDK_UART_CTRL_RXEN_Msk (1u << 1)
#define CMSDK_UART_CTRL_TXIRQEN_Msk (1u << 2)
#define CMSDK_UART_CTRL_RXIRQEN_Msk (1u << 3)
#define CMSDK_UART_INT_TX_Msk (1u << 0)
#define CMSDK_UART_INT_RX_Msk (1u << 1)

typedef struct {
  __IO uint32_t CTRL;
  __IO uint32_t VALUE;  // counts down
  __IO uint32_t RELOAD;
  __IO uint32_t INTSTATUS;  // write 1 to clear
} CMSDK_TIMER_Type;

#define CMSDK_TIMER_CTRL_EN_Msk (1u << 0)
#define CMSDK_TIMER_CTRL_IRQEN_Msk (1u << 3)
#define CMSDK_TIMER_INT_Msk (1u << 0)

typedef struct {
  __I uint32_t DATA;
  __IO uint32_t DATAOUT;
  uint32_t reserved0[2];
  __IO uint32_t OUTENSET;
  __IO uint32_t OUTENCLR;
  __IO uint32_t ALTFUNCSET;
  __IO uint32_t ALTFUNCCLR;
  __IO uint32_t INTENSET;
  __IO uint32_t INTENCLR;
  __IO uint32_t INTTYPESET;  // 1: edge, 0: level
  __IO uint32_t INTTYPECLR;
  __IO uint32_t INTPOLSET;  // 1: rising or high, 0: falling or low
  __IO uint32_t INTPOLCLR;
  __IO uint32_t INTSTATUS;  // write 1 to clear
  uint32_t reserved1[241];
  __IO uint32_t MASKLOWBYTE[256];   // address bits [9:2] select the bits of [7:0] that are touched
  __IO uint32_t MASKHIGHBYTE[256];  // the same for [15:8]
} CMSDK_GPIO_Type;

_Static_assert(sizeof(CMSDK_GPIO_Type) == 0xC00, "the mask windows lie at 0x400 and 0x800");

#define TIMER0 ((CMSDK_TIMER_Type*)0x40000000u)
#define TIMER1 ((CMSDK_TIMER_Type*)0x40001000u)
#define UART0 ((CMSDK_UART_Type*)0x40004000u)
#define UART1 ((CMSDK_UART_Type*)0x40005000u)
#define UART2 ((CMSDK_UART_Type*)0x40006000u)
#define UART3 ((CMSDK_UART_Type*)0x40007000u)
#define UART4 ((CMSDK_UART_Type*)0x40009000u)
#define GPIO0 ((CMSDK_GPIO_Type*)0x40010000u)
#define GPIO1 ((CMSDK_GPIO_Type*)0x40011000u)
#define GPIO2 ((CMSDK_GPIO_Type*)0x40012000u)
#define GPIO3 ((CMSDK_GPIO_Type*)0x40013000u)

#endif
