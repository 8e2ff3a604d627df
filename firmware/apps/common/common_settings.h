// Settings that the programs share (program_settings.h), as rows of their lists.
#ifndef CAPSOC_COMMON_SETTINGS_H
#define CAPSOC_COMMON_SETTINGS_H

// A degree in 2^-32 turn, rounded up.
#define WORDS_PER_DEGREE 11930465

#define BAUD_SETTING(NUMBER) NUMBER(uint32_t, baud, 115200, 300, 1500000, 1, "Bd", "of UART 0")
#define RATE_SETTING(NUMBER) NUMBER(uint32_t, rate_hz, 250, 1, 100000, 1, "Hz", "samples a second")
// Kept in 2^-48 Hz.
#define SPEED_SETTING(NUMBER) \
  NUMBER(int64_t, frequency_hz, 0.05, -10000, 10000, 0x1p48, "Hz", "speed of the shaft")
#define DEMODULATION_SETTING(NUMBER) \
  NUMBER(uint32_t, demodulation_samples, 100000, 1, 1e9, 1, "samples", "of demodulation")
#define CALIBRATION_SETTING(NUMBER) \
  NUMBER(uint32_t, calibration_samples, 5000, 0, 1e9, 1, "samples", "of calibration after it")
#define PROGRESS_SETTING(NUMBER) \
  NUMBER(uint32_t, progress_seconds, 50, 1, 1e9, 1, "s", "from one line of parameters to the next")
#define MIRROR_SETTING(NUMBER)                        \
  NUMBER(uint32_t, mirror_seconds, 5, 0, 1e9, 1, "s", \
         "that the rotation may seem reversed, or a turn of a fast shaft")
#define ANGLE_STRIDE_SETTING(NUMBER) \
  NUMBER(uint32_t, angle_stride, 250, 1, 1e9, 1, "samples", "from one printed angle to the next")
#define HARMONICS_SETTING(NUMBER)                                       \
  NUMBER(uint32_t, harmonics_deg, 2.5, 0, 180, WORDS_PER_DEGREE, "deg", \
         "error by harmonics along the circle, which samples alone never show")
#define LIMIT_SETTING(NUMBER)                                      \
  NUMBER(uint32_t, limit_deg, 30, 0, 180, WORDS_PER_DEGREE, "deg", \
         "largest bound of the angle error that passes")

#endif
