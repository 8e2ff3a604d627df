#include "clock.h"

#include "an385.h"
#include "bus_probe.h"
#include "capsoc_device.h"

enum { clock_controller_id = 0x43434C4B };

bool clock_present(void) {
  uint32_t id = 0;
  return bus_probe(CLOCKCTRL_BASE, &id) && id == clock_controller_id;
}

uint32_t clock_frequency_hz(void) {
  return clock_present() ? CLOCKCTRL->FREQ : AN385_CLOCK_HZ;
}

bool clock_use_pll(uint32_t multiplier, uint32_t divider) {
  clock_use_reference();
  CLOCKCTRL->STATUS = CLOCKCTRL_STATUS_ERROR_Msk;
  CLOCKCTRL->PLL = multiplier << CLOCKCTRL_PLL_MULT_Pos | divider << CLOCKCTRL_PLL_DIV_Pos;
  if ((CLOCKCTRL->STATUS & CLOCKCTRL_STATUS_ERROR_Msk) != 0) return false;
  CLOCKCTRL->CTRL = CLOCKCTRL_CTRL_PLL_EN_Msk;
  // On the reference clock a turn takes several reference cycles: twice the lock time and a margin
  // for a LOCK_TIME of 0.
  for (uint32_t turns = CLOCKCTRL->LOCK_TIME + 16; turns != 0; --turns) {
    if ((CLOCKCTRL->STATUS & CLOCKCTRL_STATUS_LOCKED_Msk) != 0) {
      CLOCKCTRL->CTRL = CLOCKCTRL_CTRL_PLL_EN_Msk | CLOCKCTRL_CTRL_SELECT_Msk;
      return true;
    }
  }
  clock_use_reference();
  return false;
}

void clock_use_reference(void) {
  CLOCKCTRL->CTRL = 0;
}
