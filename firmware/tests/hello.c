// The shortest program: one line on UART0, status 0.
#include "fixed_print.h"

int main(void) {
  print_text("hello from capsoc\n");
  return 0;
}
