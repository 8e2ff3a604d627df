// Never ends: for limits on time and instructions.
#include "fixed_print.h"

int main(void) {
  print_text("forever: looping\n");
  for (volatile unsigned turns = 0;; ++turns) {
  }
}
