// Recursive least squares of both channels' coefficients on one covariance, for
// U = a_u sin + b_u cos + c_u and V alike (Eq (13) of the SoC paper). With `forgetting` f, a sample
// that is k samples old has the weight (1 - f)^k. With `drift` q it is the Kalman filter of
// coefficients that are random walks; q is the variance of a step divided by that of the noise.
#ifndef CAPSOC_ESTIMATOR_H
#define CAPSOC_ESTIMATOR_H

enum { estimator_terms = 3 };  // sine, cosine, 1

struct estimator {
  double forgetting, drift;
  double weights[2][estimator_terms];  // of U and V, in full scale
  double covariance[estimator_terms][estimator_terms];
};

// Resets everything but the weights.
void estimator_begin(struct estimator* state);

// One sample, in full scale, at the reference's sine and cosine.
void estimator_update(struct estimator* state, double sine, double cosine, double u, double v);

#endif
