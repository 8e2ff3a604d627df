#include "program_verdict.h"

#include <stddef.h>

#include "fixed_print.h"

struct program_verdict program_verdict = {.magic = PROGRAM_VERDICT_MAGIC};

int pass_within(const char* name, uint32_t bound) {
  program_verdict.bound = bound;
  program_verdict.state = program_verdict_pass;
  print_text(name);
  print_text(": pass: every angle within ");
  // Half a millionth more, so that what is printed holds as well.
  print_fixed((int64_t)bound * 360 + 2148, 32, 6, 0);
  print_text(" deg\n");
  return 0;
}

int fail_because(const char* name, const char* reason) {
  size_t i = 0;
  for (; i + 1 < sizeof program_verdict.reason && reason[i] != '\0'; ++i)
    program_verdict.reason[i] = reason[i];
  program_verdict.reason[i] = '\0';
  program_verdict.state = program_verdict_fail;
  print_text(name);
  print_text(": fail: ");
  print_text(reason);
  print_text("\n");
  return 1;
}
