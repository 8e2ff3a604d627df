// Board set-up and the two services every program needs: a careful look at an address that may not
// exist, and the end of the program.
#ifndef CAPSOC_SYSTEM_H
#define CAPSOC_SYSTEM_H

#include <stdbool.h>
#include <stdint.h>

// Opens UART0 at 115200 baud. Called before main.
void system_init(void);

// Reads the word at `address` into `*value`. False, with `*value` untouched, if the bus answers
// with an error. Not to be called from a handler of BusFault's priority or above.
bool bus_probe(uint32_t address, uint32_t* value);

// Ends the program with a status that the debugger or simulator hands to its caller: semihosting
// SYS_EXIT_EXTENDED (Arm semihosting specification, 0x20) with ADP_Stopped_ApplicationExit.
_Noreturn void semihosting_exit(int status);

// Sleeps until `*flag_or_count` is no longer `seen`. The test and the WFI are one unit: WFI wakes
// for a pending interrupt though PRIMASK holds it back, so none is slept through.
void sleep_while_equal(const volatile uint32_t* flag_or_count, uint32_t seen);

#endif
