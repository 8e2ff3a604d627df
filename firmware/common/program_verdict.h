// The verdict of a program as an object in its memory, next to the line that it prints. `capsoc
// run` finds it by its name, puts it in the result file and compares its bound with the sensor's
// truth.
#ifndef CAPSOC_PROGRAM_VERDICT_H
#define CAPSOC_PROGRAM_VERDICT_H

#include <stdint.h>

#define PROGRAM_VERDICT_MAGIC UINT32_C(0x32524556)  // of this layout

enum program_verdict_state {
  program_verdict_none = 0,  // it has not come so far
  program_verdict_pass = 1,
  program_verdict_fail = 2,
};

// What a pass takes for granted, since the samples do not show it.
enum program_verdict_condition {
  verdict_if_no_sample_is_stale = 1,           // a sample may repeat an old one
  verdict_if_harmonics_are_small = 2,          // those along the circle stay below `unseen`
  verdict_if_every_sample_is_the_sensors = 4,  // one may lie on the circle in a wrong place
  verdict_if_no_second_signal = 8,  // at almost the sensor's speed: it looks like a drift
};

// What a pass says. Angles in 2^-32 turn.
struct verdict_claim {
  uint32_t bound;       // no angle is further from the truth at the instant of its sample
  uint32_t samples;     // the last N are covered, N this number; 0: all that the program used
  uint32_t motion;      // of the shaft from one sample to the next; 0: not known
  uint32_t unseen;      // see verdict_if_harmonics_are_small
  uint32_t conditions;  // enum program_verdict_condition, added up
};

struct program_verdict {
  uint32_t magic;
  uint32_t state;              // enum program_verdict_state
  struct verdict_claim claim;  // with pass
  char reason[160];            // with fail: one sentence; ends with a 0
};

extern struct program_verdict program_verdict;

// "<name>: pass: every angle within <bound> deg", then the samples that are meant and the
// conditions, in one line. Returns the exit status 0.
int pass_within(const char* name, const struct verdict_claim* claim);
// "<name>: fail: <reason>\n". Returns the exit status 1.
int fail_because(const char* name, const char* reason);

#endif
