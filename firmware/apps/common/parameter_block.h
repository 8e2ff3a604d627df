// The place in a program where parameters from elsewhere are written: `capsoc run --parameters`
// fills it in the image, a build with -DCALIBRATION_HEADER='"calibration.h"' takes what `capsoc
// fit` wrote.
#ifndef CAPSOC_PARAMETER_BLOCK_H
#define CAPSOC_PARAMETER_BLOCK_H

#include <stdint.h>

#include "coprocessor.h"

#define PARAMETER_BLOCK_VALID UINT32_C(0x43414C31)

struct parameter_block {
  uint32_t valid;  // PARAMETER_BLOCK_VALID: somebody wrote the parameters
  struct coprocessor_parameters parameters;
};

// Loaders find it by this name. It has to be constant, so that its bytes are in the image, and in a
// file of its own, so that the compiler does not believe the words it was built with.
extern const struct parameter_block calibration_parameters;

#endif
