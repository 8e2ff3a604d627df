#include "program_verdict.h"

#include <stddef.h>

#include "fixed_print.h"

struct program_verdict program_verdict = {.magic = PROGRAM_VERDICT_MAGIC};

static void print_verdict(const char* name, const char* word) {
  print_text(name);
  print_text(word);
}

int pass_within(const char* name, uint32_t bound) {
  program_verdict.bound = bound;
  program_verdict.state = program_verdict_pass;
  print_verdict(name, ": pass: every angle within ");
  // Rounded up: what is printed holds as well.
  const uint64_t millionths = ((uint64_t)bound * 360000000 + UINT32_MAX) >> 32;
  print_unsigned(millionths / 1000000, 0);
  print_text(".");
  for (uint32_t unit = 100000, rest = (uint32_t)(millionths % 1000000); unit != 0; unit /= 10)
    print_unsigned(rest / unit % 10, 0);
  print_text(" deg\n");
  return 0;
}

int fail_because(const char* name, const char* reason) {
  size_t i = 0;
  for (; i + 1 < sizeof program_verdict.reason && reason[i] != '\0'; ++i)
    program_verdict.reason[i] = reason[i];
  program_verdict.reason[i] = '\0';
  program_verdict.state = program_verdict_fail;
  print_verdict(name, ": fail: ");
  print_text(reason);
  print_text("\n");
  return 1;
}
