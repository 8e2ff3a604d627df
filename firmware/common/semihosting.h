// The end of a program.
#ifndef CAPSOC_SEMIHOSTING_H
#define CAPSOC_SEMIHOSTING_H

// Ends the program with a status that the debugger or simulator hands to its caller: semihosting
// SYS_EXIT_EXTENDED (Arm semihosting specification, 0x20) with ADP_Stopped_ApplicationExit.
_Noreturn void semihosting_exit(int status);

#endif
