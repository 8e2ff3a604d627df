// The status of main is the status of the simulation.
#include "fixed_print.h"

int main(void) {
  print_text("exit_code: 7\n");
  return 7;
}
