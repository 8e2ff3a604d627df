// Board set-up.
#ifndef CAPSOC_SYSTEM_H
#define CAPSOC_SYSTEM_H

// Opens UART0 at 115200 baud. Called before main.
void system_init(void);

#endif
