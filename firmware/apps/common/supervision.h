// Looks after a demodulation once a second, of a faster shaft once a turn: direction of rotation,
// lock and error flags.
#ifndef CAPSOC_SUPERVISION_H
#define CAPSOC_SUPERVISION_H

#include <stdbool.h>
#include <stdint.h>

#include "judgement.h"

struct supervision {
  const char* name;  // of the program, for the verdict
  uint32_t rate_hz;  // samples a second
  // That the mirror flag may stand before the reference is turned round; of a numeric reference no
  // longer than a turn
  uint32_t mirror_seconds;
  struct judgement judgement;  // with its settings
  // Called once a supervision_period of demodulate(), just after a result; false ends it. Null: not
  // called.
  bool (*goes_on)(const struct supervision* state);
  // The rest starts at 0.
  uint32_t mirror_since;  // sample count at which the mirror flag was first seen; 0: it is down
  uint32_t locked_at;     // sample count at which the present lock was first seen; 0: not locked
  uint32_t errors;        // COPROCESSOR_FLAGS_..._Msk that count as errors
};

// Samples from one look of a demodulation to the next: a second, or a turn of a faster numeric
// reference.
uint32_t supervision_period(const struct supervision* state);

// To be called every supervision_period samples and after the last one, just after a result, with
// the count of samples. Reports what changed and takes the record of a turn that ended. True if the
// reference was turned round (coprocessor_reverse_reference) by this call.
bool supervise(struct supervision* state, uint32_t samples);

// Supervises the first `samples` samples and prints the parameters every `progress_seconds`. False
// if the signal ended early, or `goes_on` ended it.
bool demodulate(struct supervision* state, uint32_t samples, uint32_t progress_seconds);

// One sentence for FLAGS that must not be raised; null without one.
const char* error_sentence(uint32_t errors);

// The last look at the flags, after judgement_finish. Reports the time of the lock and the verdict:
// a pass with the bound of the angle error that the last turns guarantee, or the reason why there
// is none. Returns 0 or 1.
int verdict(struct supervision* state);

// The pass alone, with what the judgement says of its samples. Returns 0.
int pass(const char* name, const struct judgement* judgement);

#endif
