// What stops a program that hangs, faults or writes where it must not: watchdog, fault handlers and
// memory protection. All end in safe_stop().
#ifndef CAPSOC_PROTECTION_H
#define CAPSOC_PROTECTION_H

#include <stdint.h>

// Status of a program that was stopped.
enum { stopped_by_watchdog = 4, stopped_by_fault = 5 };

// GPIO 0, bit 0: high while there is a checked angle.
enum { angle_good_pin = 1 };

// Ends the program at once, from any state: pin down, one line, exit.
_Noreturn void safe_stop(int status, const char* why);

// Programs the MPU: code and constants are read-only, data is not executable, and any access to the
// lowest 32 bytes of the stack faults. `block` is read-only; its size is a power of 2 from 32 bytes
// to 4 GiB, and it is aligned to its size.
void protect_memory(const void* block, uint32_t bytes);

// Stops the program unless watchdog_serve() comes within `cycles`, from now on or from the last
// one.
void watchdog_start(uint32_t cycles);
void watchdog_serve(void);

#endif
