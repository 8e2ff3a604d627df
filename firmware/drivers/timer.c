#include "timer.h"

void timer_start(CMSDK_TIMER_Type* timer, uint32_t cycles, bool with_interrupt) {
  timer->CTRL = 0;
  timer->RELOAD = cycles - 1;  // the reload itself takes one cycle
  timer->VALUE = cycles - 1;
  timer->INTSTATUS = CMSDK_TIMER_INT_Msk;
  timer->CTRL = CMSDK_TIMER_CTRL_EN_Msk | (with_interrupt ? CMSDK_TIMER_CTRL_IRQEN_Msk : 0);
}

void timer_stop(CMSDK_TIMER_Type* timer) {
  timer->CTRL = 0;
  timer->INTSTATUS = CMSDK_TIMER_INT_Msk;
}

uint32_t timer_value(const CMSDK_TIMER_Type* timer) {
  return timer->VALUE;
}

bool timer_expired(CMSDK_TIMER_Type* timer) {
  if ((timer->INTSTATUS & CMSDK_TIMER_INT_Msk) == 0) return false;
  timer->INTSTATUS = CMSDK_TIMER_INT_Msk;
  return true;
}
