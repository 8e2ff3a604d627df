// Calibration words for the firmware (parameter_block.h), by capsoc fit.
// Samples: gs.csv, SHA-256 e770392578dfb1080c3416bc91358ee3d5f0448c1feb01b09fc7ed1f480b2f47
// Method: ml, converged after 7 iterations
#ifndef CALIBRATION_H
#define CALIBRATION_H

// Q1.31
#define CALIBRATION_A1 (1354607528) // 0.630788285376
#define CALIBRATION_A2 (1071700075) // 0.499049236441
#define CALIBRATION_B1 (214723634) // 0.0999884838526
#define CALIBRATION_B2 (-107373327) // -0.0499996014895

// 2^-32 turn
#define CALIBRATION_BETA 136867645u // 0.200226152446 rad
#define CALIBRATION_PHI 0u // 0 rad

#endif
