// In its own file: what main() reads must not be the words that the compiler saw.
#include "parameter_block.h"

#ifdef CALIBRATION_HEADER
#include CALIBRATION_HEADER
const struct parameter_block calibration_parameters = {
    .valid = PARAMETER_BLOCK_VALID,
    .parameters = {.a1 = CALIBRATION_A1,
                   .a2 = CALIBRATION_A2,
                   .b1 = CALIBRATION_B1,
                   .b2 = CALIBRATION_B2,
                   .beta = CALIBRATION_BETA,
                   .phi = CALIBRATION_PHI},
};
#else
const struct parameter_block calibration_parameters = {0};
#endif

#ifdef CALIBRATION_NODES
const struct parameter_table calibration_table = {PARAMETER_BLOCK_VALID, CALIBRATION_NODES};
#else
const struct parameter_table calibration_table = {0};
#endif
