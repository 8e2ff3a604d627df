// Whether the raw samples of both channels lie on an ellipse, whatever the motion: tells a sensor
// that is broken from one that is moved in a way the program does not expect. Touches no register,
// so that it runs on a host as well.
#ifndef CAPSOC_SIGNAL_SHAPE_H
#define CAPSOC_SIGNAL_SHAPE_H

#include <stdbool.h>
#include <stdint.h>

struct signal_shape {
  uint32_t samples;
  int32_t u_first, v_first;                          // Q1.31; the moments are about it
  int32_t u_least, u_greatest, v_least, v_greatest;  // Q1.31
  double moments[5][5];                              // [i][j]: sum of u^i v^j, i + j up to 4
};

// An ellipse as a sensor's: full scale 1, radians, |beta| below a quarter turn.
struct signal_ellipse {
  double a1, a2, b1, b2, beta;
};

enum signal_kind {
  signal_unknown,   // too few samples
  signal_at_rest,   // both channels stand still
  signal_u_dead,    // channel U stands still and the other moves
  signal_v_dead,    // channel V
  signal_same,      // the channels are in phase or opposite: a line
  signal_elliptic,  // an ellipse, or an arc of one
  signal_other,     // neither
};

void signal_shape_feed(struct signal_shape* shape, int32_t u, int32_t v);

// What the samples lie on. The ellipse is written for signal_elliptic only.
enum signal_kind signal_shape_kind(const struct signal_shape* shape,
                                   struct signal_ellipse* ellipse);

#endif
