#include "program_verdict.h"

#include <stddef.h>

#include "fixed_print.h"

struct program_verdict program_verdict = {.magic = PROGRAM_VERDICT_MAGIC};

// Rounded up, so that what is printed holds as well.
static void print_bound(uint32_t angle) {
  print_fixed((int64_t)angle * 360 + 2148, 32, 6, 0);
  print_text(" deg");
}

static void print_conditions(const struct verdict_claim* claim) {
  static const struct {
    uint32_t condition;
    const char* text;
  } conditions[] = {
      {verdict_if_no_sample_is_stale, "no sample is stale"},
      {verdict_if_every_sample_is_the_sensors, "every sample is the sensor's"},
      {verdict_if_no_second_signal, "no second signal turns at almost its speed"},
      {verdict_if_harmonics_are_small, "harmonics along the circle stay below "},
  };
  const char* separator = ", if ";
  for (size_t i = 0; i < sizeof conditions / sizeof conditions[0]; ++i) {
    if ((claim->conditions & conditions[i].condition) == 0) continue;
    print_text(separator);
    print_text(conditions[i].text);
    separator = " and ";
    if (conditions[i].condition != verdict_if_harmonics_are_small) continue;
    print_fixed((int64_t)claim->unseen * 360, 32, 2, 0);
    print_text(" deg");
  }
}

int pass_within(const char* name, const struct verdict_claim* claim) {
  program_verdict.claim = *claim;
  program_verdict.state = program_verdict_pass;
  print_text(name);
  print_text(": pass: every angle within ");
  print_bound(claim->bound);
  if (claim->samples != 0) {
    print_text(", last ");
    print_unsigned(claim->samples, 0);
    print_text(" samples");
  }
  print_conditions(claim);
  print_text("\n");
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
