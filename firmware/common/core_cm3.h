// Cortex-M3 system registers and intrinsics, as far as this firmware uses them.
// Names follow CMSIS-Core; offsets are those of the Armv7-M Architecture Reference Manual, B3.2 to
// B3.4.
#ifndef CAPSOC_CORE_CM3_H
#define CAPSOC_CORE_CM3_H

#include <stdint.h>

#ifndef __IO
#define __I volatile const
#define __O volatile
#define __IO volatile
#endif
#ifndef __NVIC_PRIO_BITS
#define __NVIC_PRIO_BITS 3
#endif

typedef struct {
  __IO uint32_t CTRL;
  __IO uint32_t LOAD;
  __IO uint32_t VAL;
  __I uint32_t CALIB;
} SysTick_Type;

typedef struct {
  __IO uint32_t ISER[8];
  uint32_t reserved0[24];
  __IO uint32_t ICER[8];
  uint32_t reserved1[24];
  __IO uint32_t ISPR[8];
  uint32_t reserved2[24];
  __IO uint32_t ICPR[8];
  uint32_t reserved3[24];
  __I uint32_t IABR[8];
  uint32_t reserved4[56];
  __IO uint8_t IPR[240];
} NVIC_Type;

typedef struct {
  __I uint32_t CPUID;
  __IO uint32_t ICSR;
  __IO uint32_t VTOR;
  __IO uint32_t AIRCR;
  __IO uint32_t SCR;
  __IO uint32_t CCR;
  __IO uint8_t SHPR[12];
  __IO uint32_t SHCSR;
  __IO uint32_t CFSR;
  __IO uint32_t HFSR;
  __IO uint32_t DFSR;
  __IO uint32_t MMFAR;
  __IO uint32_t BFAR;
  __IO uint32_t AFSR;
} SCB_Type;

typedef struct {
  __IO uint32_t CTRL;
  __IO uint32_t CYCCNT;
} DWT_Type;

typedef struct {
  __IO uint32_t DHCSR;
  __O uint32_t DCRSR;
  __IO uint32_t DCRDR;
  __IO uint32_t DEMCR;
} CoreDebug_Type;

#define SysTick ((SysTick_Type*)0xE000E010u)
#define NVIC ((NVIC_Type*)0xE000E100u)
#define SCB ((SCB_Type*)0xE000ED00u)
#define DWT ((DWT_Type*)0xE0001000u)
#define CoreDebug ((CoreDebug_Type*)0xE000EDF0u)

#define SysTick_CTRL_ENABLE_Msk (1u << 0)
#define SysTick_CTRL_TICKINT_Msk (1u << 1)
#define SysTick_CTRL_CLKSOURCE_Msk (1u << 2)
#define SysTick_CTRL_COUNTFLAG_Msk (1u << 16)
#define SCB_SCR_SLEEPONEXIT_Msk (1u << 1)
#define SCB_CCR_UNALIGN_TRP_Msk (1u << 3)
#define SCB_CCR_DIV_0_TRP_Msk (1u << 4)
#define SCB_SHCSR_BUSFAULTENA_Msk (1u << 17)
#define SCB_CFSR_BUSFAULTSR_Msk 0x0000FF00u
#define CoreDebug_DEMCR_TRCENA_Msk (1u << 24)
#define DWT_CTRL_CYCCNTENA_Msk (1u << 0)

static inline void __disable_irq(void) {
  __asm volatile("cpsid i" ::: "memory");
}
static inline void __enable_irq(void) {
  __asm volatile("cpsie i" ::: "memory");
}
static inline void __WFI(void) {
  __asm volatile("wfi" ::: "memory");
}
static inline void __DSB(void) {
  __asm volatile("dsb" ::: "memory");
}
static inline void __ISB(void) {
  __asm volatile("isb" ::: "memory");
}

static inline uint32_t __get_PRIMASK(void) {
  uint32_t primask;
  __asm volatile("mrs %0, primask" : "=r"(primask)::"memory");
  return primask;
}

static inline void __set_PRIMASK(uint32_t primask) {
  __asm volatile("msr primask, %0" ::"r"(primask) : "memory");
}

// Interrupt numbers are those of the board, 0 to 31.
static inline void NVIC_EnableIRQ(int irq) {
  NVIC->ISER[(uint32_t)irq >> 5] = 1u << ((uint32_t)irq & 31u);
}

static inline void NVIC_DisableIRQ(int irq) {
  NVIC->ICER[(uint32_t)irq >> 5] = 1u << ((uint32_t)irq & 31u);
  __DSB();  // no interrupt of this line after the call returns
  __ISB();
}

static inline void NVIC_ClearPendingIRQ(int irq) {
  NVIC->ICPR[(uint32_t)irq >> 5] = 1u << ((uint32_t)irq & 31u);
}

// priority: 0 (most urgent) to 7; with Armv6-M to 3.
static inline void NVIC_SetPriority(int irq, uint32_t priority) {
#ifdef __ARM_ARCH_6M__
  // It takes words only.
  __IO uint32_t* const word = (__IO uint32_t*)(uintptr_t)&NVIC->IPR[irq & ~3];
  const uint32_t shift = 8u * ((uint32_t)irq & 3u);
  *word = (*word & ~(0xFFu << shift)) | priority << (shift + 6u);
#else
  NVIC->IPR[irq] = (uint8_t)(priority << (8u - __NVIC_PRIO_BITS));
#endif
}

#endif
