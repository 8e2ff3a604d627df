// The verdict of a program as an object in its memory, beside the line that it prints: `capsoc run`
// finds it by its name, puts it in the result file and holds its bound against the sensor's truth.
#ifndef CAPSOC_PROGRAM_VERDICT_H
#define CAPSOC_PROGRAM_VERDICT_H

#include <stdint.h>

#define PROGRAM_VERDICT_MAGIC UINT32_C(0x31524556)  // of this layout

enum program_verdict_state {
  program_verdict_none = 0,  // it has not come so far
  program_verdict_pass = 1,
  program_verdict_fail = 2,
};

struct program_verdict {
  uint32_t magic;
  uint32_t state;   // enum program_verdict_state
  uint32_t bound;   // with pass: no angle is further from the truth, 2^-32 turn
  char reason[96];  // with fail: one sentence; ends with a 0
};

extern struct program_verdict program_verdict;

// "<name>: pass: every angle within <bound> deg\n". Returns the exit status 0.
int pass_within(const char* name, uint32_t bound);
// "<name>: fail: <reason>\n". Returns the exit status 1.
int fail_because(const char* name, const char* reason);

#endif
