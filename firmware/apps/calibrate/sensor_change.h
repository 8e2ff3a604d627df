// What has changed of a sensor since its parameters were written, by the ellipse of its raw
// samples.
#ifndef CAPSOC_SENSOR_CHANGE_H
#define CAPSOC_SENSOR_CHANGE_H

#include "coprocessor.h"
#include "signal_shape.h"

// One sentence, valid until the next call; null if nothing has changed by 2 % (of an amplitude, or
// 0.02 rad), or the samples are on no ellipse.
const char* sensor_change(const struct signal_shape* shape,
                          const struct coprocessor_parameters* parameters);

#endif
