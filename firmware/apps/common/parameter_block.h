// The place in a program where parameters from elsewhere are written: `capsoc run --parameters`
// fills it in the image, a build with -DCALIBRATION_HEADER='"calibration.h"' takes what `capsoc
// fit` wrote.
#ifndef CAPSOC_PARAMETER_BLOCK_H
#define CAPSOC_PARAMETER_BLOCK_H

#include <stdint.h>

#include "coprocessor.h"

#define PARAMETER_BLOCK_VALID UINT32_C(0x43414C31)

struct parameter_block {
  uint32_t valid;  // PARAMETER_BLOCK_VALID: the parameters were written
  struct coprocessor_parameters parameters;
};

// Nodes of the coprocessor's harmonic correction (2^-24 turn), from `capsoc fit --use-angle`.
struct parameter_table {
  uint32_t valid;  // PARAMETER_BLOCK_VALID: the nodes were written
  int32_t nodes[128];
};

// Loaders find them by these names. They have to be constant, so that their bytes are in the image,
// and in a separate file, so that the compiler does not believe the words it was built with.
extern const struct parameter_block calibration_parameters;
extern const struct parameter_table calibration_table;

#endif
